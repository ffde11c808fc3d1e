//! How a picture is taken.

use super::camera::View;

/// Which part of the sheet is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Cells along a1 and a2.
    Cells([u32; 2]),
    /// The elements with their reference point in a rectangle around that of the first, in the file's unit.
    Patch([f64; 2]),
}

impl Extent {
    /// A patch that about fills a picture of this size and view: 13 reference radii wide, or 7 of a sheet seen from its edge.
    pub fn filling([width, height]: [u32; 2], view: View, reference_radius: f64) -> Self {
        let across = if view.is_low() { 7.0 } else { 12.6 } * reference_radius;
        let foreshortened = view.elevation_deg.to_radians().sin().abs().max(0.5);
        let deep = across * f64::from(height.max(1)) / f64::from(width.max(1)) / foreshortened;
        Extent::Patch([across, deep.min(2.0 * across)])
    }
}

/// What the colours mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBy {
    /// One colour for each kind of element: elements that differ by a translation alone are of one kind.
    #[default]
    Element,
    /// The sum of the contact forces on each element.
    Load,
    /// All elements alike.
    None,
}

/// Whether contact forces are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Forces {
    /// They are not.
    #[default]
    None,
    /// As arrows, seen through the rings: at each contact, the force on either ring. In one cell where all would hide the
    /// sheet.
    Arrows,
    /// As arrows in the whole patch.
    AllArrows,
}

/// What is behind the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// White paper.
    #[default]
    White,
    /// Nothing: the picture has an alpha channel.
    Transparent,
    /// A dark slide.
    Dark,
}

/// What stands above the sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Caption {
    /// In words.
    pub text: String,
    /// The direction of the pull, shown as an arrow along both ways.
    pub pull_deg: Option<f64>,
}

/// How a picture is taken.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Part of the sheet.
    pub extent: Extent,
    /// Direction of view.
    pub view: View,
    /// Near rings larger than far ones.
    pub perspective: bool,
    /// Behind the sheet.
    pub background: Background,
    /// Colours.
    pub color: ColorBy,
    /// Contact forces.
    pub forces: Forces,
    /// Above the sheet.
    pub caption: Option<Caption>,
    /// Draw the outline of the cell.
    pub cell: bool,
    /// Draw a scale bar.
    pub scale_bar: bool,
    /// Draw the shadow on the ground below.
    pub shadow: bool,
}

impl RenderOptions {
    /// A tilted picture of 1600 × 1200 on white.
    pub fn new(extent: Extent) -> Self {
        Self {
            size: [1600, 1200],
            extent,
            view: View::TILTED,
            perspective: false,
            background: Background::default(),
            color: ColorBy::default(),
            forces: Forces::default(),
            caption: None,
            cell: false,
            scale_bar: true,
            shadow: true,
        }
    }
}
