//! Verdicts as JUnit XML.

use touchstone_base::text::escaped;

/// The outcome of a test case.
pub enum Tested {
    Pass,
    Fail {
        message: String,
        why: String,
    },
    /// With the reason.
    Skipped(String),
}

/// A document of test suites.
pub fn document(suites: impl IntoIterator<Item = String>) -> String {
    let text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n");
    suites.into_iter().fold(text, |text, suite| text + &suite) + "</testsuites>\n"
}

/// A suite of test cases by name.
pub fn suite(name: &str, tests: &[(&str, Tested)]) -> String {
    let count = |is: fn(&Tested) -> bool| tests.iter().filter(|(_, test)| is(test)).count();
    let failed = count(|test| matches!(test, Tested::Fail { .. }));
    let skipped = count(|test| matches!(test, Tested::Skipped(_)));
    let (name, all) = (escaped(name), tests.len());
    let mut text = format!(
        "  <testsuite name=\"{name}\" tests=\"{all}\" failures=\"{failed}\" skipped=\"{skipped}\">\n"
    );
    for (id, test) in tests {
        let id = escaped(id);
        let body = match test {
            Tested::Pass => String::new(),
            Tested::Fail { message, why } => {
                format!("<failure message=\"{}\">{}</failure>", escaped(message), escaped(why))
            }
            Tested::Skipped(why) => format!("<skipped message=\"{}\"/>", escaped(why)),
        };
        text += &format!("    <testcase classname=\"{name}\" name=\"{id}\">{body}</testcase>\n");
    }
    text + "  </testsuite>\n"
}
