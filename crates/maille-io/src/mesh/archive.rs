//! Zip archives: files one after the other, deflated, the sizes of a large one in 64 bits. By PKWARE's APPNOTE 6.3, of
//! which the sections are named. Tests read it with a library.

use flate2::{Compression, CrcWriter, write::DeflateEncoder};
use std::io::{self, Seek, SeekFrom, Write};

/// Versions of the format that a reader needs (4.4.3): for deflated files, for sizes of 64 bits.
const DEFLATED: u16 = 20;
const LARGE: u16 = 45;
/// A file made on Unix (4.4.2.2) that its owner reads and writes, and others read.
const UNIX: u16 = 3 << 8;
const MODE: u32 = 0o100_644 << 16;
/// 1980-01-01, 00:00: no time of day, so that the same files give the same bytes (4.4.6).
const TIME: u32 = (1 << 5 | 1) << 16;
const DEFLATE: u16 = 8;

/// An archive that is being written.
pub(super) struct Archive<W> {
    out: W,
    /// The central directory so far (4.3.12).
    central: Vec<u8>,
    files: u16,
}

impl<W: Write + Seek> Archive<W> {
    pub(super) fn new(out: W) -> Self {
        Self { out, central: Vec::new(), files: 0 }
    }

    /// Adds a file with what `write` writes; a `large` one may have more than 4 GiB.
    pub(super) fn add(
        &mut self,
        name: &str,
        large: bool,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let begin = self.out.stream_position()?;
        self.out.write_all(&local(name, large, 0, [0, 0])?)?;
        let mut file = CrcWriter::new(DeflateEncoder::new(&mut self.out, Compression::default()));
        write(&mut file)?;
        let sum = file.crc().sum();
        let mut deflated = file.into_inner();
        deflated.try_finish()?;
        let sizes = [deflated.total_in(), deflated.total_out()];
        drop(deflated);
        // Checksum and sizes are known now.
        let end = self.out.stream_position()?;
        self.out.seek(SeekFrom::Start(begin))?;
        self.out.write_all(&local(name, large, sum, sizes)?)?;
        self.out.seek(SeekFrom::Start(end))?;

        let version = if large { LARGE } else { DEFLATED };
        self.central.extend(b"PK\x01\x02");
        self.central.extend((UNIX | version).to_le_bytes());
        self.central.extend(head(name, large, sum, sizes)?);
        // No comment, on no other disk, no attributes of its text.
        self.central.extend([0; 6]);
        self.central.extend(MODE.to_le_bytes());
        self.central.extend(short(begin)?.to_le_bytes());
        self.central.extend(tail(name, large, sizes));
        self.files += 1;
        Ok(())
    }

    /// Writes what is at the end (4.3.16).
    pub(super) fn finish(mut self) -> io::Result<()> {
        let begin = short(self.out.stream_position()?)?;
        self.out.write_all(&self.central)?;
        let mut end = b"PK\x05\x06\0\0\0\0".to_vec();
        end.extend([self.files, self.files].map(u16::to_le_bytes).concat());
        end.extend(short(self.central.len() as u64)?.to_le_bytes());
        end.extend(begin.to_le_bytes());
        end.extend([0, 0]);
        self.out.write_all(&end)
    }
}

/// A file's own header (4.3.7); `sizes` are those of the file and of what is stored.
fn local(name: &str, large: bool, sum: u32, sizes: [u64; 2]) -> io::Result<Vec<u8>> {
    Ok([&b"PK\x03\x04"[..], &head(name, large, sum, sizes)?, &tail(name, large, sizes)].concat())
}

/// What both headers of a file have.
fn head(name: &str, large: bool, sum: u32, sizes: [u64; 2]) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    head.extend([if large { LARGE } else { DEFLATED }, 0, DEFLATE].map(u16::to_le_bytes).concat());
    let [whole, stored] = if large { [u32::MAX; 2] } else { [short(sizes[0])?, short(sizes[1])?] };
    head.extend([TIME, sum, stored, whole].map(u32::to_le_bytes).concat());
    head.extend([name.len() as u16, if large { 20 } else { 0 }].map(u16::to_le_bytes).concat());
    Ok(head)
}

/// The name, and sizes of 64 bits (4.5.3).
fn tail(name: &str, large: bool, sizes: [u64; 2]) -> Vec<u8> {
    let mut tail = name.as_bytes().to_vec();
    if large {
        tail.extend([1, 16].map(u16::to_le_bytes).concat());
        tail.extend(sizes.map(u64::to_le_bytes).concat());
    }
    tail
}

fn short(number: u64) -> io::Result<u32> {
    u32::try_from(number).map_err(|_| io::Error::other("the archive would be larger than 4 GiB"))
}
