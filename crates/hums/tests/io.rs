//! Readers: layouts as they come, round trips, damaged files.
#![cfg(feature = "io")]
// Lists of ranges with one member are meant as such.
#![allow(clippy::single_range_in_vec_init)]

mod common;
use common::gaussian;
use hums::io::text::{TextOptions, TextReader};
use hums::io::{BlockReader, ReadError, Recording, mat, npy, open, parquet, read_all, wav};
use proptest::prelude::*;
use std::io::{Cursor, Write as _};
use std::sync::Arc;

fn text(content: &str) -> Result<Recording, ReadError> {
    text_with(content, &TextOptions::default())
}

fn text_with(content: &str, options: &TextOptions) -> Result<Recording, ReadError> {
    let bytes = content.as_bytes().to_vec();
    read_all(&mut TextReader::new(Cursor::new(bytes), options)?)
}

#[test]
fn analytic_layouts_are_found() {
    let expected = vec![vec![0.0, 0.5, 1.0], vec![1.25, -3e-2, 7.0]];
    for content in [
        "0,1.25\n0.5,-3e-2\n1,7\n",
        "t,acc\n0,1.25\n0.5,-3e-2\n1,7",
        "\u{feff}t,acc\r\n0,1.25\r\n0.5,-3e-2\r\n1,7\r\n",
        "# recorded by A. B., on C\n# t, acc\n0,1.25\n\n# pause\n0.5,-3e-2\n1,7\n",
        "Rate 5120\nt;acc\n[s];[g]\n0;1,25\n0,5;-3e-2\n1;7,0\n",
        "t\tacc\n0\t1.25\n0.5\t-3e-2\n1\t7\n",
        "  t    acc\n  0.0   1.25\n  0.5  -3e-2\n  1.0   7.0\n",
        "\"t\",\"acc\"\n\"0\",\"1.25\"\n\"0.5\",\"-3e-2\"\n\"1\",\"7\"\n",
        "t, acc,\n0, 1.25,\n0.5, -3e-2,\n1, 7,\n",
        "2024\nsome text\nt,acc\n0,1.25\n0.5,-3e-2\n1,7",
    ] {
        let r = text(content).unwrap();
        assert_eq!(r.channels, expected, "{content:?}");
        if content.contains("acc") {
            assert_eq!(r.names, ["t", "acc"], "{content:?}");
        } else {
            assert_eq!(r.names, ["channel 1", "channel 2"]);
        }
    }
    let one = text("acceleration\n1\n2\n3\n").unwrap();
    assert_eq!((one.names, one.channels), (vec!["acceleration".into()], vec![vec![1., 2., 3.]]));
    let comma = TextOptions { decimal_comma: Some(true), ..TextOptions::default() };
    assert_eq!(text_with("1,5\n2,5\n", &comma).unwrap().channels, [[1.5, 2.5]]);
    let skip = TextOptions { header_lines: Some(2), ..TextOptions::default() };
    assert_eq!(text_with("1,2\n3,4\n5,6\n", &skip).unwrap().channels, [[5.0], [6.0]]);
    let bar = TextOptions { delimiter: Some(b'|'), ..TextOptions::default() };
    assert_eq!(text_with("a|b\n1|2\n3|4\n", &bar).unwrap().channels, [[1.0, 3.0], [2.0, 4.0]]);
}

#[test]
fn extreme_gaps_and_faults_of_text() {
    let r = text("t,a\n0,1\n1,\n2,NaN\n3,n/a\n4,5\n").unwrap();
    assert_eq!(r.channels[0], [0.0, 1.0, 2.0, 3.0, 4.0]);
    assert!(r.channels[1][1..4].iter().all(|x| x.is_nan()));
    let gaps = hums::quality::ChannelQuality::of(&r.channels[1]).gaps;
    assert_eq!((gaps.first, gaps.samples), (Some(1), 3));
    match text("t,a\n0,1\n1,2\n2,hello\n") {
        Err(ReadError::Cell { line: 4, column: 2, text }) => assert_eq!(text, "hello"),
        other => panic!("{other:?}"),
    }
    // A bad cell in the second line is reported, not taken for a header.
    assert!(matches!(text("0,1\n1,x\n2,3\n3,4\n"), Err(ReadError::Cell { line: 2, column: 2, .. })));
    assert!(matches!(text("0,1\n1,2\n2\n"), Err(ReadError::Row { line: 3, found: 1, expected: 2 })));
    for bad in ["", "\n\n", "only words\nand more\n", "\u{0}\u{1}\u{2}", "# comment"] {
        assert!(matches!(text(bad), Err(ReadError::Format { .. })), "{bad:?}");
    }
    assert!(TextReader::new(Cursor::new(b"\xff\xfe1\x00".to_vec()), &TextOptions::default()).is_err());
    let mut reader = TextReader::new(Cursor::new(b"1,2\n3,4\n".to_vec()), &TextOptions::default()).unwrap();
    assert!(matches!(reader.read_block(5, &mut [Vec::new()]), Err(ReadError::Columns { given: 1, channels: 2 })));
}

#[test]
fn invariant_text_in_blocks_across_buffers() {
    // Longer than the buffer of 1 MiB, read in odd blocks.
    let x = gaussian(120_000, 6);
    let mut content = String::from("a,b\n");
    for (i, v) in x.iter().enumerate() {
        content.push_str(&format!("{i},{v}\n"));
    }
    assert!(content.len() > 2 << 20);
    let mut reader = TextReader::new(Cursor::new(content.into_bytes()), &TextOptions::default()).unwrap();
    let mut columns = vec![Vec::new(), Vec::new()];
    while reader.read_block(777, &mut columns).unwrap() > 0 {}
    assert_eq!(columns[1], x);
    assert_eq!(columns[0][119_999], 119_999.0);
}

proptest! {
    #[test]
    fn invariant_numbers_are_correctly_rounded(x in any::<f64>(), digits in 0_usize..20) {
        prop_assume!(x.is_finite());
        for form in [format!("{x}"), format!("{x:e}"), format!("{x:.digits$e}"), format!("{:.digits$}", x % 1e9)] {
            let found = text(&format!("{form}\n{form}\n")).unwrap().channels[0][0];
            prop_assert_eq!(found.to_bits(), form.parse::<f64>().unwrap().to_bits(), "{}", form);
        }
    }

    #[test]
    fn extreme_any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        if let Ok(mut r) = TextReader::new(Cursor::new(bytes.clone()), &TextOptions::default()) {
            let _ = read_all(&mut r);
        }
        if let Ok(mut r) = wav::WavRecording::new(Cursor::new(bytes.clone())) {
            let _ = read_all(&mut r);
        }
        if let Ok(mut r) = npy::open(Cursor::new(bytes.clone())) {
            let _ = read_all(r.as_mut());
        }
        let _ = read_mat(bytes.clone());
        let _ = read_parquet(bytes);
    }
}

fn wav_bytes(bits: u16, float: bool, frames: &[[f64; 2]]) -> Vec<u8> {
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 51_200,
        bits_per_sample: bits,
        sample_format: if float { hound::SampleFormat::Float } else { hound::SampleFormat::Int },
    };
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, spec).unwrap();
    for x in frames.iter().flatten() {
        if float {
            writer.write_sample(*x as f32).unwrap();
        } else {
            writer.write_sample((x * f64::from(bits - 1).exp2()) as i32).unwrap();
        }
    }
    writer.finalize().unwrap();
    bytes.into_inner()
}

#[test]
fn analytic_wav_of_all_widths() {
    // Exact in 8 bits, hence in all; full scale negative, and 24 bits clipped at both ends.
    let frames = [[0.0, -1.0], [0.5, 0.25], [-0.125, 0.75], [63.0 / 64.0, -63.0 / 64.0]];
    for (bits, float) in [(8, false), (16, false), (24, false), (32, false), (32, true)] {
        let bytes = wav_bytes(bits, float, &frames);
        let mut reader = wav::WavRecording::new(Cursor::new(bytes.clone())).unwrap();
        let mut columns = vec![Vec::new(), Vec::new()];
        assert_eq!(reader.read_block(3, &mut columns).unwrap(), 3);
        assert_eq!(reader.read_block(3, &mut columns).unwrap(), 1);
        assert_eq!(reader.read_block(3, &mut columns).unwrap(), 0);
        assert_eq!(reader.rate(), Some(51_200.0));
        for (i, frame) in frames.iter().enumerate() {
            assert_eq!([columns[0][i], columns[1][i]], *frame, "{bits} {float}");
        }
        // Cut off in the middle: what is there, or an error; no panic.
        for cut in 0..bytes.len() {
            if let Ok(mut r) = wav::WavRecording::new(Cursor::new(bytes[..cut].to_vec())) {
                let _ = read_all(&mut r);
            }
        }
    }
}

/// A WAV file put together by hand: form, format tag, bits, bytes a sample, stated data length, one channel of data; an odd chunk comes first.
fn raw_wav(form: &[u8; 4], tag: u16, bits: u16, width: u16, stated: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = form.to_vec();
    bytes.extend(u32::MAX.to_le_bytes());
    bytes.extend(b"WAVE");
    if form == b"RF64" {
        bytes.extend(b"ds64");
        bytes.extend(28_u32.to_le_bytes());
        bytes.extend(0_u64.to_le_bytes());
        bytes.extend((data.len() as u64).to_le_bytes());
        bytes.extend([0; 12]);
    }
    bytes.extend(b"LIST\x03\0\0\0abc\0");
    bytes.extend(b"fmt \x10\0\0\0");
    bytes.extend(tag.to_le_bytes());
    bytes.extend(1_u16.to_le_bytes());
    bytes.extend(1000_u32.to_le_bytes());
    bytes.extend((1000 * u32::from(width)).to_le_bytes());
    bytes.extend(width.to_le_bytes());
    bytes.extend(bits.to_le_bytes());
    bytes.extend(b"data");
    bytes.extend(stated.to_le_bytes());
    bytes.extend(data);
    bytes
}

fn read_wav(bytes: Vec<u8>) -> Result<Recording, ReadError> {
    read_all(&mut wav::WavRecording::new(Cursor::new(bytes))?)
}

#[test]
fn analytic_wav_of_rare_layouts() {
    // 64 bits float; the length was never filled in; a longer file than it says in RF64; 24 bits in four bytes.
    let values = [0.1_f64, -1e-3, 2.5];
    let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    for (form, stated) in [(b"RIFF", 24), (b"RIFF", 0), (b"RIFF", u32::MAX), (b"RF64", u32::MAX)] {
        assert_eq!(read_wav(raw_wav(form, 3, 64, 8, stated, &data)).unwrap().channels, [values.to_vec()]);
    }
    let wide = [0, 0, 0xc0, 0xff, 1, 0, 0, 0];
    let read = read_wav(raw_wav(b"RIFF", 1, 24, 4, 8, &wide)).unwrap();
    assert_eq!(read.channels, [vec![-0.5, 1.0 / 8_388_608.0]]);
    assert_eq!(read.rate, Some(1000.0));
    // Shorter than it says; compressed.
    assert!(matches!(read_wav(raw_wav(b"RIFF", 1, 16, 2, 80, &wide)), Err(ReadError::Format { .. })));
    assert!(matches!(read_wav(raw_wav(b"RIFF", 7, 8, 1, 8, &wide)), Err(ReadError::Format { .. })));
}

fn npy_bytes(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({shape}), }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

#[test]
fn analytic_npy_types_and_orders() {
    let read = |bytes: Vec<u8>| -> Result<Recording, ReadError> { read_all(npy::open(Cursor::new(bytes))?.as_mut()) };
    let f8: Vec<u8> = [1.0_f64, -2.5, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(read(npy_bytes("<f8", false, "6,", &f8)).unwrap().channels, [[1.0, -2.5, 3.0, 4.0, 5.0, 6.0]]);
    let pairs = [vec![1.0, 3.0, 5.0], vec![-2.5, 4.0, 6.0]];
    let halves = [vec![1.0, -2.5, 3.0], vec![4.0, 5.0, 6.0]];
    assert_eq!(read(npy_bytes("<f8", false, "3, 2", &f8)).unwrap().channels, pairs);
    assert_eq!(read(npy_bytes("<f8", true, "3, 2", &f8)).unwrap().channels, halves);
    assert_eq!(read(npy_bytes("<f8", false, "2, 3", &f8)).unwrap().channels, halves);
    assert_eq!(read(npy_bytes("<f8", true, "2, 3", &f8)).unwrap().channels, pairs);
    let i2: Vec<u8> = [-2_i16, 300].iter().flat_map(|x| x.to_be_bytes()).collect();
    assert_eq!(read(npy_bytes(">i2", false, "2,", &i2)).unwrap().channels, [[-2.0, 300.0]]);
    let f4: Vec<u8> = [0.1_f32, -7.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(read(npy_bytes("<f4", false, "2,", &f4)).unwrap().channels, [[f64::from(0.1_f32), -7.0]]);
    assert_eq!(read(npy_bytes("|u1", false, "3,", &[1, 2, 255])).unwrap().channels, [[1.0, 2.0, 255.0]]);
    for bad in [
        npy_bytes("<f8", false, "7,", &f8),
        npy_bytes("<f8", false, "2, 4", &f8),
        npy_bytes("<c16", false, "3,", &f8),
        npy_bytes("<f8", false, "1, 2, 3", &f8),
        npy_bytes("<f8", false, "9223372036854775807, 8", &f8),
    ] {
        assert!(matches!(read(bad), Err(ReadError::Format { .. })));
    }
}

/// One MAT v5 matrix element of doubles.
fn mat_array(name: &str, rows: i32, columns: i32, values: &[f64]) -> Vec<u8> {
    let mut body = Vec::new();
    let mut element = |kind: u32, data: &[u8]| {
        body.extend(kind.to_le_bytes());
        body.extend((data.len() as u32).to_le_bytes());
        body.extend(data);
        body.resize(body.len().next_multiple_of(8), 0);
    };
    element(6, &[6, 0, 0, 0, 0, 0, 0, 0]);
    element(5, &[rows.to_le_bytes(), columns.to_le_bytes()].concat());
    element(1, name.as_bytes());
    element(9, &values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>());
    let mut array = [14_u32.to_le_bytes(), (body.len() as u32).to_le_bytes()].concat();
    array.extend(body);
    array
}

fn mat_file(arrays: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0x00, 0x01, b'I', b'M']);
    arrays.iter().for_each(|a| bytes.extend(a));
    bytes
}

fn read_mat(bytes: Vec<u8>) -> Result<Recording, ReadError> {
    read_all(mat::open(Cursor::new(bytes))?.as_mut())
}

/// An array's element as `-v7` writes it.
fn compressed(array: &[u8]) -> Vec<u8> {
    let mut stream = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    stream.write_all(array).unwrap();
    let data = stream.finish().unwrap();
    [15_u32.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat().into_iter().chain(data).collect()
}

#[test]
fn invariant_mat_compressed_or_not_whole_or_in_blocks() {
    // Two vectors and a matrix by columns, longer than the buffers, read in odd blocks.
    let n = 40_000;
    let x = gaussian(5 * n, 3);
    let arrays = |wrap: &dyn Fn(&[u8]) -> Vec<u8>| {
        let n = n as i32;
        mat_file(&[
            wrap(&mat_array("fs", 1, 1, &[51_200.0])),
            wrap(&mat_array("left", n, 1, &x[..40_000])),
            wrap(&mat_array("right", 1, n, &x[40_000..80_000])),
            wrap(&mat_array("by_columns", n, 2, &x[80_000..160_000])),
        ])
    };
    for bytes in [arrays(&<[u8]>::to_vec), arrays(&compressed)] {
        let mut reader = mat::open(Cursor::new(bytes.clone())).unwrap();
        assert_eq!(reader.rate(), Some(51_200.0));
        assert_eq!(reader.channels(), ["left", "right", "by_columns(1)", "by_columns(2)"]);
        let mut columns = vec![Vec::new(); 4];
        while reader.read_block(777, &mut columns).unwrap() > 0 {}
        for (c, column) in columns.iter().enumerate() {
            assert!(*column == x[c * n..(c + 1) * n], "channel {c}");
        }
        // Broken off, it says so.
        let cut = read_mat(bytes[..bytes.len() - 1000].to_vec()).unwrap_err().to_string();
        assert!(cut.contains("element at byte") && cut.contains("the file ends"), "{cut}");
    }
    // A stream damaged in its middle tells where.
    let mut bytes = arrays(&compressed);
    let middle = bytes.len() - 200_000;
    bytes[middle..middle + 64].fill(0xff);
    let fault = read_mat(bytes).unwrap_err().to_string();
    assert!(fault.contains("\"by_columns"), "{fault}");
}

#[test]
fn extreme_mat_of_other_versions_and_sizes() {
    let says = |bytes: Vec<u8>| read_mat(bytes).unwrap_err().to_string();
    let mut later = mat_file(&[]);
    later[124..126].copy_from_slice(&[0, 2]);
    assert!(says(later).contains("save it with -v7"));
    assert!(says(vec![0; 200]).contains("neither IM nor MI"));
    assert!(says(vec![0; 20]).contains("shorter than its header"));
    let mut wrong = mat_array("x", 4, 1, &[1.0; 4]);
    wrong[32] = 5; // rows
    assert!(says(mat_file(&[wrong])).contains("array \"x\" of 5 by 1 numbers of 8 bytes has 32 bytes"));
    // Big-endian, as older machines wrote.
    let mut big = b"MATLAB 5.0 MAT-file".to_vec();
    big.resize(124, b' ');
    big.extend([0x01, 0x00, b'M', b'I']);
    for word in [14_u32, 56, 6, 8, 6, 0, 5, 8, 3, 1, 0x0001_0001, 0x6100_0000, 3, 6, 0x0001_0002, 0xffff_0000] {
        big.extend(word.to_be_bytes());
    }
    let r = read_mat(big).unwrap();
    assert_eq!((r.names, r.channels), (vec!["a".to_owned()], vec![vec![1.0, 2.0, -1.0]]));
}

#[test]
fn peer_scipy_mat_and_arrow_parquet() {
    // Written by scipy and pyarrow: tests/data/recordings.py.
    let x: Vec<f64> = (0..100).map(|i| f64::from(i * i % 97) / 8.0).collect();
    for file in ["plain.mat", "compressed.mat"] {
        let bytes = std::fs::read(format!("tests/data/{file}")).unwrap();
        let r = read_mat(bytes).unwrap();
        assert_eq!((r.rate, &r.names[..]), (Some(5120.0), &["case".into(), "pair(1)".into(), "pair(2)".into()][..]));
        assert!(r.channels[0] == x && r.channels[1] == x, "{file}");
        assert!(r.channels[2].iter().zip(&x).all(|(a, b)| *a == -b), "{file}");
    }
    for codec in ["none", "snappy", "gzip", "lz4", "zstd"] {
        let r = read_parquet(std::fs::read(format!("tests/data/{codec}.parquet")).unwrap()).unwrap();
        assert_eq!(r.rate, Some(5120.0));
        assert_eq!(r.names, ["time", "case", "single", "gaps", "tacho", "counts", "bytes"]);
        for (i, x) in x.iter().enumerate() {
            let at = |channel: usize| r.channels[channel][i];
            // 2024-01-01 and i steps of 1/5120 s to a nanosecond; f64 holds 2.4e-7 s there.
            assert!((at(0) - 1_704_067_200.0 - i as f64 / 5120.0).abs() < 5e-7, "{codec} {i}");
            assert_eq!((at(1), at(2)), (*x, *x), "{codec} {i}");
            assert!(if i % 7 == 3 { at(3).is_nan() } else { at(3) == *x }, "{codec} {i}");
            assert_eq!((at(4), at(5)), (f64::from(u8::from(i % 10 == 0)), i as f64 * 5e6 - 2.5e9), "{codec} {i}");
            assert_eq!(at(6), (i % 256) as f64);
        }
    }
}

fn read_parquet(bytes: Vec<u8>) -> Result<Recording, ReadError> {
    read_all(&mut parquet::ParquetRecording::new(bytes::Bytes::from(bytes), &Arc::default())?)
}

#[test]
fn extreme_damaged_parquet_is_read_or_refused() {
    let bytes = std::fs::read("tests/data/snappy.parquet").unwrap();
    for cut in (0..bytes.len()).step_by(7) {
        assert!(matches!(read_parquet(bytes[..cut].to_vec()), Err(ReadError::Format { .. })), "{cut}");
    }
    for at in (0..bytes.len()).step_by(5) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0xff;
        let _ = read_parquet(damaged);
    }
}

#[test]
fn analytic_mat_vectors_and_matrices() {
    let bytes = mat_file(&[
        mat_array("fs", 1, 1, &[5120.0]),
        mat_array("acc", 4, 1, &[1.0, 2.0, 3.0, 4.0]),
        mat_array("sensors", 2, 4, &[1.0, 5.0, 2.0, 6.0, 3.0, 7.0, 4.0, 8.0]),
        mat_array("other", 1, 2, &[9.0, 9.0]),
    ]);
    let r = read_mat(bytes.clone()).unwrap();
    assert_eq!(r.rate, Some(5120.0));
    assert_eq!(r.names, ["acc", "sensors(1)", "sensors(2)"]);
    let up = vec![1.0, 2.0, 3.0, 4.0];
    assert_eq!(r.channels, [up.clone(), up, vec![5.0, 6.0, 7.0, 8.0]]);
    for cut in 0..bytes.len() {
        // Broken off before its last array, it is a shorter recording; anywhere else it is an error.
        let _ = read_mat(bytes[..cut].to_vec());
    }
    for at in 128..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0xff;
        let _ = read_mat(damaged);
    }
    assert!(matches!(
        mat::open(Cursor::new(mat_file(&[mat_array("fs", 1, 1, &[1.0])]))),
        Err(ReadError::Format { .. })
    ));
}

#[test]
fn analytic_files_by_extension() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rec.CSV");
    std::fs::write(&path, "t,a\n0,1\n0.25,2\n0.5,3\n").unwrap();
    let mut reader = open(&path, &TextOptions::default()).unwrap();
    let r = read_all(reader.as_mut()).unwrap();
    assert_eq!(hums::time_axis::step_of(&r.channels[0]).unwrap(), 0.25);
    for (file, channels) in [("snappy.parquet", 7), ("compressed.mat", 3)] {
        let mut reader = open(&std::path::Path::new("tests/data").join(file), &TextOptions::default()).unwrap();
        let r = read_all(reader.as_mut()).unwrap();
        assert_eq!((r.rate, r.channels.len(), r.channels[0].len()), (Some(5120.0), channels, 100), "{file}");
    }
    let missing = open(&folder.path().join("no.csv"), &TextOptions::default());
    assert!(matches!(missing, Err(ReadError::File { .. })));
    let unknown = open(&folder.path().join("x.h5"), &TextOptions::default());
    assert!(matches!(unknown, Err(ReadError::UnknownExtension { .. })));
}

/// Only regular files: a device never ends, a pipe waits for its writer.
#[cfg(unix)]
#[test]
fn extreme_devices_and_pipes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["rec.csv", "rec.mat", "rec.parquet"] {
        let link = folder.path().join(name);
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        assert!(matches!(open(&link, &TextOptions::default()), Err(ReadError::NotRegular { .. })), "{name}");
    }
    let pipe = folder.path().join("pipe.csv");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    assert!(matches!(open(&pipe, &TextOptions::default()), Err(ReadError::NotRegular { .. })));
}
