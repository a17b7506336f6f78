//! The JSON schema of a scene, for editors and for programs that write scenes.

use schemars::schema_for;
use serde_json::{Number, Value};

use super::Scene;

/// Describes every key of a scene file, with its type, default and range.
///
/// RON writes an enum's variant as `Name(…)`; the schema shows it as JSON does, as an object with
/// the one key `Name`.
pub fn json_schema() -> Value {
    let mut schema = schema_for!(Scene).to_value();
    write_decimals_short(&mut schema);
    schema
}

/// A default of 0.6 in a 32-bit float is 0.6000000238418579 in JSON's 64 bits; this writes it as 0.6
/// again.
fn write_decimals_short(value: &mut Value) {
    match value {
        Value::Number(number) => {
            let wide = number.as_f64().filter(|_| number.is_f64());
            let narrow = wide
                .map(|x| x as f32)
                .filter(|x| Some(f64::from(*x)) == wide);
            let short = narrow.and_then(|x| x.to_string().parse().ok());
            if let Some(short) = short.and_then(Number::from_f64) {
                *number = short;
            }
        }
        Value::Array(items) => items.iter_mut().for_each(write_decimals_short),
        Value::Object(fields) => fields.values_mut().for_each(write_decimals_short),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_described_and_limited() {
        let schema = json_schema();
        assert_eq!(schema["title"], "Scene");
        let duration = &schema["properties"]["duration_s"];
        assert_eq!(duration["maximum"], 172_800.0);
        assert_eq!(duration["default"], 4.0);
        let solver = &schema["$defs"]["Solver"]["properties"];
        assert_eq!(solver["segments"]["maximum"], 16.0);
        assert!(solver["segments"]["description"].is_string());
        assert_eq!(
            schema["$defs"]["Body"]["required"],
            serde_json::json!(["name", "shape"])
        );
        assert_eq!(schema["additionalProperties"], false);
        assert_eq!(
            schema["$defs"]["Body"]["properties"]["friction"]["default"],
            0.6
        );
    }
}
