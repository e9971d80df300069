//! VTK unstructured grids (`.vtu`) as ParaView reads them: XML with inline base64 binary data, little-endian, 64-bit headers
//! (VTK file formats, *The VTK User's Guide*, 11th edition, chapter 19).

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// Shape of all cells of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellShape {
    /// Four points, VTK type 9.
    Quad,
    /// Eight points, VTK type 12.
    Hexahedron,
}

impl CellShape {
    fn points(self) -> usize {
        match self {
            Self::Quad => 4,
            Self::Hexahedron => 8,
        }
    }

    fn vtk_type(self) -> u8 {
        match self {
            Self::Quad => 9,
            Self::Hexahedron => 12,
        }
    }
}

/// A named field with `components` values per point or cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Name with unit.
    pub name: String,
    /// Values per point or cell.
    pub components: usize,
    /// All values.
    pub values: Vec<f64>,
}

/// An unstructured grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Cell shape.
    pub shape: CellShape,
    /// Coordinates, three per point.
    pub points: Vec<f64>,
    /// Point numbers of all cells.
    pub cells: Vec<u32>,
    /// Fields on points.
    pub point_fields: Vec<Field>,
    /// Fields on cells.
    pub cell_fields: Vec<Field>,
}

impl Grid {
    /// The file's text.
    #[must_use]
    pub fn to_xml(&self) -> String {
        let per_cell = self.shape.points();
        let count = self.cells.len() / per_cell;
        let mut xml = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n<UnstructuredGrid>\n",
        );
        let _ = writeln!(xml, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{count}\">", self.points.len() / 3);
        for (section, fields) in [("PointData", &self.point_fields), ("CellData", &self.cell_fields)] {
            let _ = writeln!(xml, "<{section}>");
            for field in fields {
                xml.push_str(&floats(&field.name, field.components, &field.values));
            }
            let _ = writeln!(xml, "</{section}>");
        }
        xml.push_str("<Points>\n");
        xml.push_str(&floats("position", 3, &self.points));
        xml.push_str("</Points>\n<Cells>\n");
        let connectivity: Vec<u8> = self.cells.iter().flat_map(|&c| i64::from(c).to_le_bytes()).collect();
        let offsets: Vec<u8> = (1..=count).flat_map(|k| ((k * per_cell) as i64).to_le_bytes()).collect();
        xml.push_str(&array("Int64", "connectivity", 1, &connectivity));
        xml.push_str(&array("Int64", "offsets", 1, &offsets));
        xml.push_str(&array("UInt8", "types", 1, &vec![self.shape.vtk_type(); count]));
        xml.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        xml
    }

    /// Writes the file.
    ///
    /// # Errors
    /// I/O errors.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        std::fs::write(path, self.to_xml())
    }
}

fn floats(name: &str, components: usize, values: &[f64]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    array("Float64", name, components, &bytes)
}

fn array(kind: &str, name: &str, components: usize, bytes: &[u8]) -> String {
    let mut data = (bytes.len() as u64).to_le_bytes().to_vec();
    data.extend_from_slice(bytes);
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">{}</DataArray>\n",
        STANDARD.encode(data)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invariant_values_survive_the_encoding() {
        let grid = Grid {
            shape: CellShape::Quad,
            points: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 2.5, 0.0, 0.0, 1.0, 0.0],
            cells: vec![0, 1, 2, 3],
            point_fields: vec![],
            cell_fields: vec![Field { name: "pressure_mpa".into(), components: 1, values: vec![123.25] }],
        };
        let xml = grid.to_xml();
        assert!(xml.contains("NumberOfPoints=\"4\" NumberOfCells=\"1\""));
        let start = xml.find("pressure_mpa").unwrap();
        let data = &xml[start..];
        let data = &data[data.find('>').unwrap() + 1..data.find("</").unwrap()];
        let bytes = STANDARD.decode(data).unwrap();
        assert_eq!(u64::from_le_bytes(bytes[..8].try_into().unwrap()), 8);
        assert_eq!(f64::from_le_bytes(bytes[8..].try_into().unwrap()), 123.25);
    }
}
