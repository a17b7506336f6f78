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
        case(xml, expectation, &name);
    }
    xml.push_str("  </testsuite>\n");
}

fn run_case(xml: &mut String, scenario: &Scenario, suite: &str) {
    let head = format!("    <testcase classname=\"{suite}\" name=\"runs\"");
    let message = match &scenario.error {
        Some(error) => attribute(error),
        None if unfinite(scenario) => {
            format!("{} values were not finite", scenario.metrics.nan_count)
        }
        None => {
            line(xml, format_args!("{head}/>"));
            return;
        }
    };
    line(xml, format_args!("{head}>"));
    line(xml, format_args!("      <error message=\"{message}\"/>"));
    line(xml, format_args!("    </testcase>"));
}

fn unfinite(scenario: &Scenario) -> bool {
    scenario.metrics.nan_count > 0
}

fn case(xml: &mut String, expectation: &Expectation, suite: &str) {
    let at = expectation
        .at
        .map_or(String::new(), |at| format!(" at {at} s"));
    let name = attribute(&format!("{}{at}", expectation.what));
    let head = format!("    <testcase classname=\"{suite}\" name=\"{name}\"");
    let reason = expectation.reason.as_deref().unwrap_or_default();
    match expectation.passed {
        Some(true) => line(xml, format_args!("{head}/>")),
        Some(false) => {
            let message = attribute(&format!("{} {reason}", measured(expectation)));
            line(xml, format_args!("{head}>"));
            line(
                xml,
                format_args!("      <failure message=\"{}\"/>", message.trim()),
            );
            line(xml, format_args!("    </testcase>"));
        }
        None => {
            line(xml, format_args!("{head}>"));
            line(
                xml,
                format_args!("      <skipped message=\"{}\"/>", attribute(reason)),
            );
            line(xml, format_args!("    </testcase>"));
        }
    }
}

/// What was measured against its limit, in words.
fn measured(expectation: &Expectation) -> String {
    let value =
        |v: Option<f64>| v.map_or("nothing".into(), |v| format!("{v} {}", expectation.unit));
    let measured = value(expectation.measured);
    let limit = value(expectation.limit);
    format!("measured {}, limit {}", measured.trim(), limit.trim())
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
