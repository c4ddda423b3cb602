//! Results as JSON, and the check that every number of a result is finite.
//!
//! Every result passes this check before it is printed, drawn or written, as text or as JSON. A
//! value that is legitimately absent is an `Option`: `null` in JSON, `-` in text.

use std::fmt;

use serde::ser::{self, Serialize};

/// Error of a result that cannot be shown.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResultError {
    /// A number is infinite or not a number.
    #[error(
        "found {value} for `{quantity}`, expected a finite number: an input is too large or too small for this result"
    )]
    NotFinite {
        /// Path of the quantity in the result, e.g. `places[0].force_n`.
        quantity: String,
        /// The value as text.
        value: String,
    },
    /// The result cannot be written as JSON.
    #[error("the result cannot be written as JSON: {0}")]
    Json(String),
}

impl ser::Error for ResultError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::Json(message.to_string())
    }
}

/// Checks that every number in `result` is finite.
///
/// # Errors
/// [`ResultError::NotFinite`] with the path of the first number that is not.
pub fn check_finite<R: Serialize + ?Sized>(result: &R) -> Result<(), ResultError> {
    result.serialize(&mut Check::default())
}

/// `result` as indented JSON.
///
/// # Errors
/// As [`check_finite`].
pub fn to_json<R: Serialize + ?Sized>(result: &R) -> Result<String, ResultError> {
    check_finite(result)?;
    serde_json::to_string_pretty(result).map_err(ser::Error::custom)
}

/// A serialiser that writes nothing and knows the path of the value that it visits.
#[derive(Default)]
struct Check {
    path: Vec<String>,
}

impl Check {
    fn number(&self, value: f64) -> Result<(), ResultError> {
        if value.is_finite() {
            return Ok(());
        }
        let mut quantity = self.path.concat();
        if quantity.is_empty() {
            "the result".clone_into(&mut quantity);
        }
        let quantity = quantity.trim_start_matches('.').to_owned();
        Err(ResultError::NotFinite { quantity, value: value.to_string() })
    }

    fn inside<R: Serialize + ?Sized>(
        &mut self,
        step: String,
        value: &R,
    ) -> Result<(), ResultError> {
        self.path.push(step);
        value.serialize(&mut *self)?;
        self.path.pop();
        Ok(())
    }
}

/// The elements or fields of a value.
struct Parts<'a> {
    check: &'a mut Check,
    index: usize,
    key: String,
}

impl Parts<'_> {
    fn element<R: Serialize + ?Sized>(&mut self, value: &R) -> Result<(), ResultError> {
        self.index += 1;
        self.check.inside(format!("[{}]", self.index - 1), value)
    }
}

macro_rules! always_finite {
    ($($method:ident: $kind:ty),*) => {
        $(fn $method(self, _: $kind) -> Result<(), ResultError> {
            Ok(())
        })*
    };
}

impl<'a> ser::Serializer for &'a mut Check {
    type Ok = ();
    type Error = ResultError;
    type SerializeSeq = Parts<'a>;
    type SerializeTuple = Parts<'a>;
    type SerializeTupleStruct = Parts<'a>;
    type SerializeTupleVariant = Parts<'a>;
    type SerializeMap = Parts<'a>;
    type SerializeStruct = Parts<'a>;
    type SerializeStructVariant = Parts<'a>;

    always_finite!(
        serialize_bool: bool, serialize_i8: i8, serialize_i16: i16, serialize_i32: i32,
        serialize_i64: i64, serialize_u8: u8, serialize_u16: u16, serialize_u32: u32,
        serialize_u64: u64, serialize_char: char, serialize_str: &str, serialize_bytes: &[u8],
        serialize_unit_struct: &'static str
    );

    fn serialize_f32(self, value: f32) -> Result<(), ResultError> {
        self.number(value.into())
    }

    fn serialize_f64(self, value: f64) -> Result<(), ResultError> {
        self.number(value)
    }

    fn serialize_none(self) -> Result<(), ResultError> {
        Ok(())
    }

    fn serialize_some<R: Serialize + ?Sized>(self, value: &R) -> Result<(), ResultError> {
        value.serialize(self)
    }

    fn serialize_unit(self) -> Result<(), ResultError> {
        Ok(())
    }

    fn serialize_unit_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
    ) -> Result<(), ResultError> {
        Ok(())
    }

    fn serialize_newtype_struct<R: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &R,
    ) -> Result<(), ResultError> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<R: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        value: &R,
    ) -> Result<(), ResultError> {
        self.inside(format!(".{variant}"), value)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Parts<'a>, ResultError> {
        Ok(Parts { check: self, index: 0, key: String::new() })
    }

    fn serialize_tuple(self, length: usize) -> Result<Parts<'a>, ResultError> {
        self.serialize_seq(Some(length))
    }

    fn serialize_tuple_struct(
        self,
        _: &'static str,
        length: usize,
    ) -> Result<Parts<'a>, ResultError> {
        self.serialize_seq(Some(length))
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        length: usize,
    ) -> Result<Parts<'a>, ResultError> {
        self.serialize_seq(Some(length))
    }

    fn serialize_map(self, length: Option<usize>) -> Result<Parts<'a>, ResultError> {
        self.serialize_seq(length)
    }

    fn serialize_struct(self, _: &'static str, length: usize) -> Result<Parts<'a>, ResultError> {
        self.serialize_seq(Some(length))
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        length: usize,
    ) -> Result<Parts<'a>, ResultError> {
        self.serialize_seq(Some(length))
    }
}

macro_rules! elements {
    ($($kind:ident: $method:ident),*) => {
        $(impl ser::$kind for Parts<'_> {
            type Ok = ();
            type Error = ResultError;

            fn $method<R: Serialize + ?Sized>(&mut self, value: &R) -> Result<(), ResultError> {
                self.element(value)
            }

            fn end(self) -> Result<(), ResultError> {
                Ok(())
            }
        })*
    };
}

elements!(
    SerializeSeq: serialize_element,
    SerializeTuple: serialize_element,
    SerializeTupleStruct: serialize_field,
    SerializeTupleVariant: serialize_field
);

macro_rules! fields {
    ($($kind:ident),*) => {
        $(impl ser::$kind for Parts<'_> {
            type Ok = ();
            type Error = ResultError;

            fn serialize_field<R: Serialize + ?Sized>(
                &mut self,
                key: &'static str,
                value: &R,
            ) -> Result<(), ResultError> {
                self.check.inside(format!(".{key}"), value)
            }

            fn end(self) -> Result<(), ResultError> {
                Ok(())
            }
        })*
    };
}

fields!(SerializeStruct, SerializeStructVariant);

impl ser::SerializeMap for Parts<'_> {
    type Ok = ();
    type Error = ResultError;

    fn serialize_key<R: Serialize + ?Sized>(&mut self, key: &R) -> Result<(), ResultError> {
        let text = serde_json::to_value(key).map_err(ser::Error::custom)?;
        self.key = text.as_str().map_or_else(|| text.to_string(), str::to_owned);
        Ok(())
    }

    fn serialize_value<R: Serialize + ?Sized>(&mut self, value: &R) -> Result<(), ResultError> {
        let step = format!(".{}", self.key);
        self.check.inside(step, value)
    }

    fn end(self) -> Result<(), ResultError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Serialize;

    use super::{ResultError, check_finite, to_json};

    #[derive(Serialize)]
    struct Inner {
        force_n: f64,
        known: Option<f64>,
    }

    #[derive(Serialize)]
    struct Outer {
        title: &'static str,
        places: Vec<Inner>,
        #[serde(flatten)]
        more: BTreeMap<String, f64>,
    }

    fn outer(force_n: f64, known: Option<f64>, more: f64) -> Outer {
        let places = vec![Inner { force_n: 1.0, known: None }, Inner { force_n, known }];
        Outer { title: "inf", places, more: BTreeMap::from([("step_hz".to_owned(), more)]) }
    }

    #[test]
    fn a_number_that_is_not_finite_is_refused_with_its_path() {
        assert_eq!(check_finite(&outer(2.0, Some(3.0), 4.0)), Ok(()));
        for (result, quantity, value) in [
            (outer(f64::INFINITY, None, 1.0), "places[1].force_n", "inf"),
            (outer(1.0, Some(f64::NAN), 1.0), "places[1].known", "NaN"),
            (outer(1.0, None, f64::NEG_INFINITY), "step_hz", "-inf"),
        ] {
            let (quantity, value) = (quantity.to_owned(), value.to_owned());
            assert_eq!(check_finite(&result), Err(ResultError::NotFinite { quantity, value }));
            assert!(to_json(&result).is_err());
        }
        assert!(to_json(&outer(1.0, None, 1.0)).is_ok_and(|text| text.contains("\"known\": null")));
    }
}
