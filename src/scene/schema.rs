//! The JSON schema of a scene, for editors and for programs that write scenes.

use schemars::schema_for;

use super::Scene;

/// Describes every key of a scene file, with its type, default and range.
///
/// RON writes an enum's variant as `Name(…)`; the schema shows it as JSON does, as an object with
/// the one key `Name`.
pub fn json_schema() -> serde_json::Value {
    schema_for!(Scene).to_value()
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
    }
}
