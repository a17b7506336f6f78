//! Putting shaders together from embedded files and constants: see [`wgsl`](super::wgsl).

use std::fmt::Write;

use super::wgsl::{Constant, Value, WgslFile};

/// Why a shader could not be put together.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum WgslError {
    #[error("{file}:{line}: no embedded shader file is called '{import}'")]
    UnknownImport {
        file: &'static str,
        line: usize,
        import: String,
    },
    #[error("no embedded shader file is called '{path}'")]
    UnknownFile { path: String },
    #[error("{file}:{line}: an import reads: #import \"folder/file.wgsl\"")]
    BadImport { file: &'static str, line: usize },
    #[error("constant {name} has the values {first:?} and {second:?}; give one another name")]
    TwoValues {
        name: &'static str,
        first: Value,
        second: Value,
    },
}

/// A shader ready for the compiler.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// Path of the file that was asked for.
    pub path: &'static str,
    pub text: String,
    /// Where each file's text starts: line in `text` (from 1), and the file.
    starts: Vec<(u32, &'static str)>,
}

impl Assembled {
    /// `file:line` of a line of `text`, counted from 1.
    pub fn place(&self, line: u32) -> String {
        match self.starts.iter().rev().find(|(start, _)| *start <= line) {
            Some((start, file)) => format!("shaders/{file}:{}", line - start + 1),
            None => format!("constants of {}:{line}", self.path),
        }
    }

    /// A compiler's message with each `wgsl:line:column` of the assembled text turned into the
    /// file and line it came from. The text is searched because the compiler's structured
    /// locations are missing for some errors.
    pub fn explain(&self, message: &str) -> String {
        let mut pieces = message.split("wgsl:");
        let mut out = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            let digits = piece.chars().take_while(char::is_ascii_digit).count();
            match piece[..digits].parse() {
                Ok(line) => out.push_str(&self.place(line)),
                Err(_) => {
                    out.push_str("wgsl:");
                    out.push_str(&piece[..digits]);
                }
            }
            out.push_str(&piece[digits..]);
        }
        out
    }
}

/// Puts `file` together with everything it imports from `libraries`.
///
/// # Errors
/// An import that is unknown or malformed; two constants of one name and different values.
pub fn assemble(file: &WgslFile, libraries: &[&[WgslFile]]) -> Result<Assembled, WgslError> {
    assemble_with(file, libraries, &[])
}

/// As [`assemble`], with other values for the constants named in `instead`.
///
/// # Errors
/// As for [`assemble`].
pub fn assemble_with(
    file: &WgslFile,
    libraries: &[&[WgslFile]],
    instead: &[Constant],
) -> Result<Assembled, WgslError> {
    let mut parts = Vec::new();
    gather(file, libraries, &mut parts)?;

    let mut constants: Vec<Constant> = Vec::new();
    for constant in parts.iter().flat_map(|part| (part.constants)()) {
        match constants.iter().find(|known| known.name == constant.name) {
            Some(known) if known.value == constant.value => {}
            Some(known) => {
                return Err(WgslError::TwoValues {
                    name: constant.name,
                    first: known.value.clone(),
                    second: constant.value,
                });
            }
            None => constants.push(constant),
        }
    }

    let mut text = String::new();
    for constant in &constants {
        let other = instead.iter().find(|other| other.name == constant.name);
        let constant = other.unwrap_or(constant);
        write_constant(&mut text, constant);
    }
    let mut starts = Vec::new();
    for part in parts.iter().rev() {
        starts.push((text.lines().count() as u32 + 1, part.path));
        for line in part.text.lines() {
            // An import line stays as a comment, so that line numbers hold.
            let comment = if line.trim_start().starts_with('#') {
                "// "
            } else {
                ""
            };
            text.push_str(comment);
            text.push_str(line);
            text.push('\n');
        }
    }
    Ok(Assembled {
        path: file.path,
        text,
        starts,
    })
}

/// Puts together the file called `path` in one of the libraries.
///
/// # Errors
/// As for [`assemble`]; `UnknownFile` if there is no such file.
pub fn assemble_named(path: &str, libraries: &[&[WgslFile]]) -> Result<Assembled, WgslError> {
    match find(path, libraries) {
        Some(file) => assemble(file, libraries),
        None => Err(WgslError::UnknownFile {
            path: path.to_owned(),
        }),
    }
}

fn find<'a>(path: &str, libraries: &[&'a [WgslFile]]) -> Option<&'a WgslFile> {
    libraries
        .iter()
        .flat_map(|library| library.iter())
        .find(|file| file.path == path)
}

/// Appends `file` and, after it, what it imports and `parts` does not hold yet.
fn gather(
    file: &WgslFile,
    libraries: &[&[WgslFile]],
    parts: &mut Vec<WgslFile>,
) -> Result<(), WgslError> {
    parts.push(*file);
    for (index, line) in file.text.lines().enumerate() {
        let Some(rest) = line.trim_start().strip_prefix('#') else {
            continue;
        };
        let line = index + 1;
        let name = rest
            .strip_prefix("import \"")
            .and_then(|rest| rest.trim_end().strip_suffix('"'))
            .ok_or(WgslError::BadImport {
                file: file.path,
                line,
            })?;
        if parts.iter().any(|part| part.path == name) {
            continue;
        }
        let found = find(name, libraries).ok_or_else(|| WgslError::UnknownImport {
            file: file.path,
            line,
            import: name.to_owned(),
        })?;
        gather(found, libraries, parts)?;
    }
    Ok(())
}

fn write_constant(text: &mut String, constant: &Constant) {
    let name = constant.name;
    let (kind, value) = match &constant.value {
        Value::U32(v) => ("u32".to_owned(), format!("{v}u")),
        Value::I32(v) => ("i32".to_owned(), format!("{v}i")),
        Value::F32(v) => ("f32".to_owned(), f32_literal(*v)),
        Value::F32Array(v) => {
            let items: Vec<String> = v.iter().map(|x| f32_literal(*x)).collect();
            let kind = format!("array<f32, {}>", v.len());
            let value = format!("{kind}({})", items.join(", "));
            (kind, value)
        }
        Value::U32Array(v) => {
            let items: Vec<String> = v.iter().map(|x| format!("{x}u")).collect();
            let kind = format!("array<u32, {}>", v.len());
            let value = format!("{kind}({})", items.join(", "));
            (kind, value)
        }
    };
    // Writing to a string cannot fail.
    let _ = writeln!(text, "const {name}: {kind} = {value};");
}

/// A literal that reads back as exactly `value`: `{:e}` prints the shortest text that does.
fn f32_literal(value: f32) -> String {
    format!("{value:e}f")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &'static str, text: &'static str) -> WgslFile {
        WgslFile {
            path,
            text,
            constants: Vec::new,
        }
    }

    #[test]
    fn imports_come_once_and_circles_end() {
        let library = [
            file("a.wgsl", "#import \"b.wgsl\"\nfn a() {}"),
            file("b.wgsl", "#import \"a.wgsl\"\nfn b() {}"),
        ];
        let main = file(
            "m.wgsl",
            "// head\n#import \"a.wgsl\"\n#import \"b.wgsl\"\nfn m() {}",
        );
        let made = assemble(&main, &[&library]).expect("known files");
        for function in ["fn a()", "fn b()", "fn m()"] {
            assert_eq!(made.text.matches(function).count(), 1, "{function}");
        }
        let line = made.text.lines().position(|l| l == "fn m() {}").expect("m") + 1;
        assert_eq!(made.place(line as u32), "shaders/m.wgsl:4");
        let line = made.text.lines().position(|l| l == "fn b() {}").expect("b") + 1;
        assert_eq!(made.place(line as u32), "shaders/b.wgsl:2");
        let told = made.explain(&format!("oh: wgsl:{line}:7 (m.wgsl: so)"));
        assert_eq!(told, "oh: shaders/b.wgsl:2:7 (m.wgsl: so)");
    }

    #[test]
    fn bad_imports_are_named() {
        let unknown = file("m.wgsl", "\n#import \"nowhere.wgsl\"");
        assert_eq!(
            assemble(&unknown, &[]).expect_err("unknown"),
            WgslError::UnknownImport {
                file: "m.wgsl",
                line: 2,
                import: "nowhere.wgsl".into()
            }
        );
        let bad = file("m.wgsl", "#include <x>");
        assert!(matches!(
            assemble(&bad, &[]),
            Err(WgslError::BadImport { line: 1, .. })
        ));
    }

    #[test]
    fn constants_read_back_exactly() {
        for value in [0.1_f32, 1.0, -2.5e-38, f32::MAX, 1e-3] {
            let text = f32_literal(value);
            let back: f32 = text.trim_end_matches('f').parse().expect("a float");
            assert_eq!(back.to_bits(), value.to_bits(), "{text}");
        }
    }
}
