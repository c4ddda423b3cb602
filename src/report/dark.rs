//! Pictures in light on dark, made of those in dark on white.

/// Darkest and lightest grey of the dark pictures, of 255.
const ENDS: (f64, f64) = (16.0, 228.0);

/// The picture `svg` with the lightness of all its colours turned round: hues stay, and with them
/// what the legend names.
pub fn on_dark(svg: &str) -> String {
    // Text without a colour of its own is black.
    let svg = svg.replacen("<svg ", "<svg fill=\"#000000\" ", 1);
    let mut parts = svg.split("=\"");
    let mut dark = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        dark.push_str("=\"");
        let (value, rest) = part.split_once('"').unwrap_or((part, ""));
        dark.push_str(&colour(value).map_or_else(|| value.to_owned(), turned));
        dark.push('"');
        dark.push_str(rest);
    }
    dark
}

/// Red, green and blue of `#rrggbb` or `rgb(r,g,b)`.
fn colour(value: &str) -> Option<[f64; 3]> {
    let parts: Vec<u8> = if let Some(digits) = value.strip_prefix('#').filter(|d| d.len() == 6) {
        let number = u32::from_str_radix(digits, 16).ok()?;
        number.to_be_bytes().get(1..)?.to_vec()
    } else {
        let inside = value.strip_prefix("rgb(")?.strip_suffix(')')?;
        inside.split(',').map(str::parse).collect::<Result<_, _>>().ok()?
    };
    let [red, green, blue] = parts.try_into().ok()?;
    Some([red, green, blue].map(f64::from))
}

/// `L` becomes `1 - L` (HSL) at the same hue and saturation: `c + 1 - max - min` for each part,
/// then between both ends.
fn turned(parts: [f64; 3]) -> String {
    let high = parts.into_iter().fold(0.0, f64::max);
    let low = parts.into_iter().fold(255.0, f64::min);
    let scaled = |part: f64| ENDS.0 + (ENDS.1 - ENDS.0) * (part + 255.0 - high - low) / 255.0;
    let [red, green, blue] = parts.map(scaled);
    format!("rgb({red:.0},{green:.0},{blue:.0})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hues_stay_and_lightness_turns_round() {
        let svg = "<svg viewBox=\"0 0 1 1\"><rect fill=\"#ffffff\"/><path d=\"M0 0\" stroke=\"#0072b2\"/><text>a=\"b\"</text></svg>";
        let dark = on_dark(svg);
        // By hand: white and black are the ends; 0, 114, 178 turn to 77, 191, 255, then between the
        // ends.
        for colour in ["fill=\"rgb(228,228,228)\" v", "fill=\"rgb(16,16,16)\"", "rgb(80,175,228)"] {
            assert!(dark.contains(colour), "{colour} in {dark}");
        }
        assert!(dark.contains("<text>a=\"b\"</text>"), "{dark}");
    }
}
