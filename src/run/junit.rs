//! The report as JUnit XML: a test suite per scenario, a test case per expectation.

use std::fmt::Write;

use super::report::{Expectation, Report, Scenario};

/// The whole report as a document.
pub fn junit(report: &Report) -> String {
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n");
    for scenario in &report.scenarios {
        suite(&mut xml, scenario);
    }
    xml.push_str("</testsuites>\n");
    xml
}

fn suite(xml: &mut String, scenario: &Scenario) {
    let count = |passed| {
        let expectations = scenario.expectations.iter();
        expectations.filter(|e| e.passed == passed).count()
    };
    let (failures, skipped) = (count(Some(false)), count(None));
    let name = attribute(&scenario.name);
    let errors = u32::from(scenario.error.is_some() || unfinite(scenario));
    // The run itself is a case, so that a scene without expectations still shows up.
    let tests = scenario.expectations.len() + 1;
    line(
        xml,
        format_args!(
            "  <testsuite name=\"{name}\" tests=\"{tests}\" failures=\"{failures}\" \
             errors=\"{errors}\" skipped=\"{skipped}\" time=\"{:.3}\">",
            scenario.wall_s
        ),
    );
    run_case(xml, scenario, &name);
    for expectation in &scenario.expectations {
        expectation_case(xml, expectation, &name);
    }
    xml.push_str("  </testsuite>\n");
}

fn run_case(xml: &mut String, scenario: &Scenario, suite: &str) {
    let error = match &scenario.error {
        Some(error) => Some(error.clone()),
        None if unfinite(scenario) => {
            let count = scenario.metrics.nan_count;
            Some(format!("{count} plants with values that are not finite"))
        }
        None => None,
    };
    case(xml, suite, "runs", error.map(|text| ("error", text)));
}

fn unfinite(scenario: &Scenario) -> bool {
    scenario.metrics.nan_count > 0
}

fn expectation_case(xml: &mut String, expectation: &Expectation, suite: &str) {
    let name = match expectation.at {
        Some(at) => format!("{} at {at} s", expectation.what),
        None => expectation.what.clone(),
    };
    let reason = expectation.reason.clone().unwrap_or_default();
    let outcome = match expectation.passed {
        Some(true) => None,
        Some(false) => Some(("failure", format!("{} {reason}", measured(expectation)))),
        None => Some(("skipped", reason)),
    };
    case(xml, suite, &name, outcome);
}

/// What was measured against its limit, in words.
fn measured(expectation: &Expectation) -> String {
    let value = |v: f64| format!("{v} {}", expectation.unit).trim_end().to_owned();
    match (expectation.measured, expectation.limit) {
        (Some(measured), Some(limit)) => {
            format!("measured {}, limit {}", value(measured), value(limit))
        }
        (Some(measured), None) => format!("measured {}", value(measured)),
        (None, _) => "not measured:".into(),
    }
}

/// A test case; `outcome` is the tag and message of one that did not pass.
fn case(xml: &mut String, suite: &str, name: &str, outcome: Option<(&str, String)>) {
    let name = attribute(name);
    let head = format!("    <testcase classname=\"{suite}\" name=\"{name}\"");
    let Some((tag, message)) = outcome else {
        line(xml, format_args!("{head}/>"));
        return;
    };
    let message = attribute(message.trim());
    line(xml, format_args!("{head}>"));
    line(xml, format_args!("      <{tag} message=\"{message}\"/>"));
    line(xml, format_args!("    </testcase>"));
}

fn line(xml: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(xml, "{text}");
}

/// Text as an attribute's value; characters that XML 1.0 does not allow become U+FFFD.
fn attribute(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            '\t' => escaped.push_str("&#9;"),
            '\r' => escaped.push_str("&#13;"),
            c if c < ' ' || c == '\u{fffe}' || c == '\u{ffff}' => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::report::tests::sample;

    #[test]
    fn failures_errors_and_skips_are_told_apart() {
        let xml = junit(&sample());
        assert_eq!(xml.matches("<testsuite ").count(), 2);
        assert_eq!(xml.matches("<testcase ").count(), 4);
        assert!(
            xml.contains("failures=\"1\" errors=\"0\" skipped=\"1\""),
            "{xml}"
        );
        assert!(
            xml.contains("<failure message=\"measured 12.25 °, limit 40 °\"/>"),
            "{xml}"
        );
        assert!(xml.contains("<skipped message=\"only the cpu"), "{xml}");
        assert!(
            xml.contains("<error message=\"no such &lt;file&gt;\"/>"),
            "{xml}"
        );
        assert_eq!(xml.matches("<testcase ").count(), xml.matches("/>").count());
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(
            attribute("a<b> & \"c\"\n\u{1}é"),
            "a&lt;b&gt; &amp; &quot;c&quot;&#10;\u{fffd}é"
        );
    }
}
