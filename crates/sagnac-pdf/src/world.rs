//! What the typesetter sees: the document, its drawings and the fonts, all in memory.

use crate::fonts::{FONT_BOOK, SHIPPED_FONTS};
use crate::{Paper, layout};
use std::collections::HashMap;
use typst::diag::{FileError, FileResult};
use typst::foundations::{Bytes, Datetime, Duration};
use typst::syntax::{FileId, RootedPath, Source, VirtualPath, VirtualRoot};
use typst::text::{Font, FontBook};
use typst::utils::LazyHash;
use typst::{Library, LibraryExt, World};

/// The files of one document.
pub struct InMemory {
    library: LazyHash<Library>,
    main: Source,
    files: HashMap<FileId, Bytes>,
}

impl InMemory {
    /// The files of a paper.
    pub fn of_paper(paper: &Paper<'_>) -> InMemory {
        let drawings = paper.drawings.iter().map(|(name, svg)| (name.as_str(), svg.as_slice()));
        let all = drawings.chain(paper.attachments.iter().map(|a| (a.name, a.bytes)));
        InMemory::new(layout::document(paper), all)
    }

    /// A document in the typesetter's language with the files that it names.
    pub fn new<'a>(document: String, all: impl Iterator<Item = (&'a str, &'a [u8])>) -> InMemory {
        // A name that is no path of this world is not found when the document asks for it.
        let files = all.filter_map(|(name, bytes)| Some((id(name)?, Bytes::new(bytes.to_vec())))).collect();
        let main = match id(layout::MAIN_FILE) {
            Some(id) => Source::new(id, document),
            None => Source::detached(document),
        };
        InMemory { library: LazyHash::new(Library::default()), main, files }
    }
}

fn id(name: &str) -> Option<FileId> {
    Some(RootedPath::new(VirtualRoot::Project, VirtualPath::new(name).ok()?).intern())
}

impl World for InMemory {
    fn library(&self) -> &LazyHash<Library> {
        &self.library
    }

    fn book(&self) -> &LazyHash<FontBook> {
        &FONT_BOOK
    }

    fn main(&self) -> FileId {
        self.main.id()
    }

    fn source(&self, id: FileId) -> FileResult<Source> {
        if id == self.main.id() { Ok(self.main.clone()) } else { Err(missing(id)) }
    }

    fn file(&self, id: FileId) -> FileResult<Bytes> {
        self.files.get(&id).cloned().ok_or_else(|| missing(id))
    }

    fn font(&self, index: usize) -> Option<Font> {
        SHIPPED_FONTS.get(index).cloned()
    }

    /// No document depends on the day on which it is typeset.
    fn today(&self, _: Option<Duration>) -> Option<Datetime> {
        None
    }
}

fn missing(id: FileId) -> FileError {
    FileError::NotFound(id.get().vpath().get_without_slash().into())
}
