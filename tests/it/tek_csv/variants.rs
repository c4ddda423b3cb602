//! Generated tables, 256 of each class: separators, decimal marks, digits, units, orders of
//! columns, triggers off the grid. Each is read with the values that it is made of, within its
//! printed digits, or refused; none is misread.

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::read_all;
use hertzscope::scope::Source;
use proptest::prelude::*;

use crate::seeded;

/// What a table is made of.
#[derive(Debug, Clone)]
struct Table {
    points: usize,
    /// Sample interval (s).
    interval: f64,
    /// Time of the first row, in intervals.
    first: f64,
    channels: Vec<u8>,
    /// Names and seconds in one, and volts in one, of the printed units.
    time_unit: (&'static str, f64),
    volt_unit: (&'static str, f64),
    separator: &'static str,
    decimal_comma: bool,
    /// Significant digits of times beyond those that tell rows apart.
    spare_digits: i32,
    order: Order,
    style: usize,
    end: &'static str,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Order {
    TimeFirst,
    TimeLast,
    IndexFirst,
    SideBySide,
}

fn volts(channel: u8, point: usize) -> f64 {
    // Whole levels of 40 mV, neither even nor monotonous.
    let level = (point * point * 7 + point * usize::from(channel) * 13) % 101;
    (level as f64 - 50.0) * 0.04
}

impl Table {
    fn time(&self, point: usize) -> f64 {
        (point as f64 + self.first) * self.interval
    }

    fn decimals(&self) -> i32 {
        let step = self.interval / self.time_unit.1;
        1 - step.log10().floor() as i32 + self.spare_digits
    }

    fn number(&self, value: f64, decimals: i32) -> String {
        let text = format!("{value:.*}", usize::try_from(decimals.max(0)).unwrap());
        if self.decimal_comma { text.replace('.', ",") } else { text }
    }

    fn time_cell(&self, point: usize) -> String {
        self.number(self.time(point) / self.time_unit.1, self.decimals())
    }

    fn volt_cell(&self, channel: u8, point: usize) -> String {
        self.number(
            volts(channel, point) / self.volt_unit.1,
            if self.volt_unit.1 < 1.0 { 1 } else { 3 },
        )
    }

    fn name(&self, name: &str, unit: &str) -> String {
        match self.style {
            0 => format!("{name} ({unit})"),
            1 => format!("{name} [{unit}]"),
            2 => format!("{name} in {unit}"),
            3 => format!("{name}_{unit}"),
            _ => format!("{name}/{unit}"),
        }
        // Names are one word where blanks separate.
        .replace(' ', if self.separator == " " { "" } else { " " })
    }

    fn text(&self) -> String {
        let time = || self.name("Time", self.time_unit.0);
        let channel = |number: &u8| self.name(&format!("CH{number}"), self.volt_unit.0);
        let mut rows: Vec<Vec<String>> = vec![Vec::new(); self.points + 1];
        for (index, row) in rows.iter_mut().enumerate() {
            let cells = |row: &mut Vec<String>, number: &u8| {
                row.push(match index.checked_sub(1) {
                    None => channel(number),
                    Some(point) => self.volt_cell(*number, point),
                });
            };
            let time = |row: &mut Vec<String>| {
                row.push(index.checked_sub(1).map_or_else(time, |point| self.time_cell(point)));
            };
            match self.order {
                Order::IndexFirst => {
                    row.push(if index == 0 { "n".to_owned() } else { (index - 1).to_string() });
                }
                Order::TimeLast => self.channels.iter().for_each(|number| cells(row, number)),
                Order::TimeFirst | Order::SideBySide => {}
            }
            match self.order {
                Order::SideBySide => self.channels.iter().for_each(|number| {
                    time(row);
                    cells(row, number);
                }),
                Order::TimeLast => time(row),
                _ => {
                    time(row);
                    self.channels.iter().for_each(|number| cells(row, number));
                }
            }
        }
        rows.iter().map(|row| row.join(self.separator) + self.end).collect()
    }

    /// That what was read is what the table is made of.
    fn check(&self, found: &[Capture]) {
        let text = self.text();
        assert_eq!(found.len(), self.channels.len(), "{text}");
        let digit = 10f64.powi(-self.decimals()) * self.time_unit.1;
        for (capture, number) in found.iter().zip(&self.channels) {
            let waveform = &capture.waveform;
            assert_eq!(waveform.source, Source::Channel(*number), "{text}");
            assert_eq!(
                (waveform.preamble.x_unit.as_str(), waveform.preamble.y_unit.as_str()),
                ("s", "V")
            );
            assert_eq!(waveform.codes.len(), self.points, "{text}");
            for point in 0..self.points {
                let (time, value) = (waveform.time(point), waveform.volts(point).unwrap());
                // Half a digit of the text, and half a digit of the spacing that is found.
                assert!(
                    (time - self.time(point)).abs() <= 1.05 * digit,
                    "{point}: {time}, {}\n{text}",
                    self.time(point)
                );
                assert!((value - volts(*number, point)).abs() < 1e-3, "{point}: {value}\n{text}");
            }
        }
    }
}

fn tables() -> impl Strategy<Value = Table> {
    let layout = (
        3..40_usize,
        prop::sample::select(vec![1e-9, 4e-8, 2.5e-7, 1e-6, 3.2e-5, 7.711e-6, 1e-4, 2e-3]),
        prop_oneof![Just(0.0), (-30..5_i32).prop_map(f64::from), -30.0..5.0_f64],
        prop::sample::select(vec![
            vec![1],
            vec![2],
            vec![1, 2],
            vec![3, 1],
            vec![1, 2, 3, 4],
            vec![5, 8],
        ]),
        prop::sample::select(vec![
            ("s", 1.0),
            ("ms", 1e-3),
            ("us", 1e-6),
            ("µs", 1e-6),
            ("ns", 1e-9),
            ("min", 60.0),
        ]),
        prop::sample::select(vec![("V", 1.0), ("mV", 1e-3), ("uV", 1e-6), ("kV", 1e3)]),
    );
    let writing = (
        prop::sample::select(vec![
            (",", false),
            (";", false),
            (";", true),
            ("\t", false),
            ("\t", true),
            (" ", false),
            (" ", true),
        ]),
        0..4_i32,
        prop::sample::select(vec![
            Order::TimeFirst,
            Order::TimeLast,
            Order::IndexFirst,
            Order::SideBySide,
        ]),
        0..5_usize,
        prop::sample::select(vec!["\n", "\r\n", "\r"]),
    );
    (layout, writing).prop_map(
        |(
            (points, interval, first, channels, time_unit, volt_unit),
            ((separator, decimal_comma), spare_digits, order, style, end),
        )| Table {
            points,
            interval,
            first,
            channels,
            time_unit,
            // Three decimals of kilovolts are whole volts: too coarse for these values.
            volt_unit: if volt_unit.1 > 1.0 { ("V", 1.0) } else { volt_unit },
            separator,
            decimal_comma,
            spare_digits,
            order,
            // `_min` may be a minimum, and names with blanks are several words where blanks
            // separate.
            style: match (style, time_unit.0, separator) {
                (3, "min", _) | (2, _, " ") => 0,
                _ => style,
            },
            end,
        },
    )
}

proptest! {
    #![proptest_config(seeded(256))]

    #[test]
    fn named_tables_are_read_right(table in tables()) {
        match read_all(table.text().as_bytes(), "table.csv") {
            Ok(found) => table.check(&found),
            Err(error) => panic!("{error}\n{}", table.text()),
        }
    }

    /// Without names only the plainest order can be told; the others are refused.
    #[test]
    fn tables_without_names_are_read_right_or_refused(table in tables()) {
        let text = table.text();
        let body: String = text.split_inclusive(table.end).skip(1).collect();
        let nameless = Table {
            // The file tells no unit and no channel.
            time_unit: (table.time_unit.0, table.time_unit.1),
            ..table.clone()
        };
        if let Ok(found) = read_all(body.as_bytes(), "table.csv") {
            // Seconds and volts are assumed, and said to be.
            for capture in &found {
                let assumed = |what: &str| capture.notes.iter().any(|note| note.starts_with(what));
                prop_assert!(assumed("unit of the times") && assumed("unit of the values"));
            }
            let seconds = Table {
                interval: nameless.interval / nameless.time_unit.1,
                time_unit: ("s", 1.0),
                ..nameless.clone()
            };
            let digit = 10f64.powi(-seconds.decimals());
            prop_assert_eq!(found.len(), seconds.channels.len());
            for (capture, number) in found.iter().zip(&seconds.channels) {
                for point in 0..seconds.points {
                    prop_assert!((capture.waveform.time(point) - seconds.time(point)).abs() <= 1.05 * digit);
                    let value = capture.waveform.volts(point).unwrap() * seconds.volt_unit.1;
                    prop_assert!((value - volts(*number, point)).abs() < 1e-3);
                }
            }
        }
    }

    /// A row that is off by more than its digits, or missing: refused, whatever the form.
    #[test]
    fn uneven_tables_are_refused(table in tables(), at in any::<prop::sample::Index>()) {
        let text = table.text();
        let mut lines: Vec<&str> = text.split_inclusive(table.end).collect();
        if table.points >= 5 {
            lines.remove(2 + at.index(table.points - 2));
            prop_assert!(read_all(lines.concat().as_bytes(), "table.csv").is_err(), "{}", lines.concat());
        }
    }
}
