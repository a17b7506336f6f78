//! Where assets come from: folders, or bytes in the program.

use std::fs;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use crate::scene::error::AssetError;

/// A place to read assets from by the path a scene gives.
pub trait AssetSource {
    /// The bytes of a file.
    ///
    /// # Errors
    /// A file that is not there, lies outside, cannot be read or has more than `limit` bytes.
    fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, AssetError>;
}

/// Folders, looked through in order. A path may not leave the folder it is found in.
#[derive(Clone, Debug)]
pub struct Folders(Vec<PathBuf>);

impl Folders {
    pub fn new(folders: impl IntoIterator<Item = PathBuf>) -> Self {
        Self(folders.into_iter().collect())
    }

    fn find(&self, file: &str) -> Result<PathBuf, AssetError> {
        let relative = inside(file).ok_or_else(|| outside(file))?;
        for folder in &self.0 {
            let Ok(folder) = folder.canonicalize() else {
                continue;
            };
            // Resolves links, so that the comparison below sees where they lead.
            if let Ok(path) = folder.join(&relative).canonicalize() {
                return if path.starts_with(&folder) {
                    Ok(path)
                } else {
                    Err(outside(file))
                };
            }
        }
        let folders: Vec<_> = self.0.iter().map(|f| f.display().to_string()).collect();
        Err(AssetError::NotFound {
            file: file.to_owned(),
            folders: if folders.is_empty() {
                "none were given".to_owned()
            } else {
                folders.join(", ")
            },
        })
    }
}

impl AssetSource for Folders {
    fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, AssetError> {
        let path = self.find(file)?;
        let unreadable = |reason: String| AssetError::Unreadable {
            file: file.to_owned(),
            reason,
        };
        let about = fs::metadata(&path).map_err(|e| unreadable(e.to_string()))?;
        // Opening a pipe would wait for its writer.
        if !about.is_file() {
            return Err(unreadable("it is no regular file".to_owned()));
        }
        within(file, about.len(), limit)?;
        let opened = fs::File::open(&path).map_err(|e| unreadable(e.to_string()))?;
        let mut bytes = Vec::new();
        // The file may have grown since it was measured.
        let read = opened.take(limit.saturating_add(1)).read_to_end(&mut bytes);
        read.map_err(|e| unreadable(e.to_string()))?;
        within(file, bytes.len() as u64, limit)?;
        Ok(bytes)
    }
}

/// Files in the program itself: paths with their bytes.
#[derive(Clone, Copy, Debug)]
pub struct Embedded<'a>(pub &'a [(&'a str, &'a [u8])]);

impl AssetSource for Embedded<'_> {
    fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, AssetError> {
        let found = self.0.iter().find(|(path, _)| *path == file);
        let (_, bytes) = found.ok_or_else(|| AssetError::NotFound {
            file: file.to_owned(),
            folders: "the program's own assets".to_owned(),
        })?;
        within(file, bytes.len() as u64, limit)?;
        Ok(bytes.to_vec())
    }
}

/// Two sources: what the first does not have is looked up in the second.
#[derive(Clone, Copy)]
pub struct InOrder<'a>(pub &'a dyn AssetSource, pub &'a dyn AssetSource);

impl AssetSource for InOrder<'_> {
    fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, AssetError> {
        match self.0.read(file, limit) {
            // Where neither has it, the first knows the folders that can be told.
            Err(missing @ AssetError::NotFound { .. }) => match self.1.read(file, limit) {
                Err(AssetError::NotFound { .. }) => Err(missing),
                found => found,
            },
            found => found,
        }
    }
}

/// The path `file` means beside another asset, such as a buffer beside its glTF file.
pub(super) fn beside(neighbour: &str, file: &str) -> String {
    match neighbour.rfind('/') {
        Some(end) => format!("{}{file}", &neighbour[..=end]),
        None => file.to_owned(),
    }
}

/// The path without `.`; `None` if it is absolute, empty or has `..` in it.
fn inside(file: &str) -> Option<PathBuf> {
    // A zero byte ends a path for some systems; a backslash parts folders on others only.
    if file.contains(['\0', '\\']) {
        return None;
    }
    let mut path = PathBuf::new();
    for component in Path::new(file).components() {
        match component {
            Component::Normal(name) => path.push(name),
            Component::CurDir => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    (!path.as_os_str().is_empty()).then_some(path)
}

fn outside(file: &str) -> AssetError {
    AssetError::Outside {
        file: file.to_owned(),
    }
}

fn within(file: &str, bytes: u64, limit: u64) -> Result<(), AssetError> {
    if bytes <= limit {
        return Ok(());
    }
    Err(AssetError::TooLarge {
        file: file.to_owned(),
        bytes,
        limit,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_inside() {
        assert_eq!(inside("./a/b.obj"), Some(PathBuf::from("a/b.obj")));
        for bad in [
            "",
            ".",
            "..",
            "../a",
            "a/../../b",
            "/etc/passwd",
            "a\\b",
            "a\0",
        ] {
            assert_eq!(inside(bad), None, "{bad:?}");
        }
        assert_eq!(beside("assets/chair.gltf", "chair.bin"), "assets/chair.bin");
        assert_eq!(beside("chair.gltf", "chair.bin"), "chair.bin");
    }

    #[test]
    fn the_first_folder_wins_and_links_may_not_lead_out() {
        let base = std::env::temp_dir().join(format!("sward-folders-{}", std::process::id()));
        let [one, two] = ["one", "two"].map(|n| base.join(n));
        for folder in [&one, &two] {
            fs::create_dir_all(folder).expect("a temporary folder");
        }
        fs::write(one.join("both"), "first").expect("a temporary file");
        fs::write(two.join("both"), "second").expect("a temporary file");
        fs::write(two.join("late"), "late").expect("a temporary file");
        let source = Folders::new([one.clone(), two.clone()]);
        assert_eq!(source.read("both", 10).ok(), Some(b"first".to_vec()));
        assert_eq!(source.read("late", 10).ok(), Some(b"late".to_vec()));
        assert!(matches!(
            source.read("late", 3),
            Err(AssetError::TooLarge {
                bytes: 4,
                limit: 3,
                ..
            })
        ));
        assert!(matches!(
            source.read("never", 9),
            Err(AssetError::NotFound { .. })
        ));
        assert!(matches!(
            source.read("../two/late", 9),
            Err(AssetError::Outside { .. })
        ));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&two, one.join("way_out")).expect("a temporary link");
            let only_one = Folders::new([one]);
            assert!(matches!(
                only_one.read("way_out/late", 9),
                Err(AssetError::Outside { .. })
            ));
        }
        fs::remove_dir_all(&base).expect("the temporary folder goes");
    }
}
