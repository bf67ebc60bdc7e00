//! Layout: the names of the joints, the unit and the axes of a data set.

use super::asf::Asf;
use super::pose::Channel;
use crate::data::tracks::LineError;
use crate::data::tracks::line::quoted;

const INCH: f64 = 0.0254;

/// The axis that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// y; the floor plane is (x, -z).
    Y,
    /// z; the floor plane is (x, y).
    Z,
}

/// How to read the files of a data set. The end of a BVH joint without children (`End Site`) has the name of the joint
/// and `.end`.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Metres per unit of length.
    pub unit: f64,
    /// The axis that points up.
    pub up: Up,
    /// Frames per second, for files without a frame rate.
    pub fps: Option<f64>,
    /// Frames at the begin of each take that are no motion.
    pub skip: usize,
    /// Whether the position channels of a BVH joint replace its offset; else they are added to it.
    pub replace_offsets: bool,
    /// Whether angles are in radians, not in degrees.
    pub radians: bool,
    /// The center of the hip.
    pub root: String,
    /// The left ankle and toe.
    pub left: [String; 2],
    /// The right ankle and toe.
    pub right: [String; 2],
}

impl Layout {
    /// A preset by its name; see [`Layout::presets`].
    pub fn named(name: &str) -> Option<Self> {
        Self::presets().into_iter().find(|(preset, _)| *preset == name).map(|(_, layout)| layout)
    }

    /// The preset of the format that the extension of a file says, and its name; with a skeleton in its unit.
    pub fn of_file(file: &str, skeleton: Option<&Asf>) -> Option<(&'static str, Self)> {
        let extension = file.rsplit_once('.').map_or("", |(_, extension)| extension).to_ascii_lowercase();
        let name = match extension.as_str() {
            "amc" => "cmu-asfamc",
            "csv" | "bvh" => extension.as_str(),
            _ => return None,
        };
        let (preset, layout) = Self::presets().into_iter().find(|(preset, _)| *preset == name)?;
        Some((preset, Self { unit: skeleton.map_or(layout.unit, |asf| INCH / asf.unit), ..layout }))
    }

    /// A value of a channel in the unit of the file, in degrees if it is an angle.
    pub(super) fn degrees(&self, (channel, value): (Channel, f64)) -> (Channel, f64) {
        let is_radian = self.radians && matches!(channel, Channel::Turn(_));
        (channel, if is_radian { value.to_degrees() } else { value })
    }

    /// The presets: the CMU data set as ASF/AMC and as BVH of the cgspeed release (its first frame is an artificial pose), the
    /// BVH files of the Bandai-Namco research data set, BVH files with the most frequent names of joints, and CSV tables of
    /// positions in metres.
    pub fn presets() -> [(&'static str, Self); 5] {
        let of = |unit, root: &str, left: [&str; 2], right: [&str; 2]| Self {
            unit,
            up: Up::Y,
            fps: None,
            skip: 0,
            replace_offsets: false,
            radians: false,
            root: root.to_owned(),
            left: left.map(str::to_owned),
            right: right.map(str::to_owned),
        };
        // The unit of ASF is an inch divided by the `length` of the skeletons.
        let asf = of(INCH / 0.45, "root", ["ltibia", "ltoes"], ["rtibia", "rtoes"]);
        let bvh = of(0.01, "Hips", ["LeftFoot", "LeftToeBase"], ["RightFoot", "RightToeBase"]);
        let cmu = of(0.01, "hip", ["lFoot", "lFoot.end"], ["rFoot", "rFoot.end"]);
        let bandai = of(0.01, "Hips", ["Foot_L", "Toes_L"], ["Foot_R", "Toes_R"]);
        [
            ("cmu-asfamc", Self { fps: Some(120.0), ..asf }),
            ("cmu-bvh", Self { skip: 1, ..cmu }),
            ("bandai-namco", Self { replace_offsets: true, ..bandai }),
            ("bvh", bvh),
            ("csv", of(1.0, "hip", ["lankle", "ltoe"], ["rankle", "rtoe"])),
        ]
    }

    /// The root, left ankle, left toe, right ankle and right toe.
    pub(super) fn joints(&self) -> [&str; 5] {
        let ([a, b], [c, d]) = (&self.left, &self.right);
        [&self.root, a, b, c, d].map(String::as_str)
    }

    /// Where these joints are among those of a skeleton.
    pub(super) fn find(&self, skeleton: &[&str]) -> Result<[usize; 5], LineError> {
        let wanted = self.joints();
        let at = wanted.map(|name| skeleton.iter().position(|joint| *joint == name));
        let lacking: Vec<String> =
            wanted.iter().zip(at).filter(|(_, at)| at.is_none()).map(|(name, _)| quoted(name)).collect();
        if lacking.is_empty() {
            return Ok(at.map(Option::unwrap_or_default));
        }
        let feet = if at[1..].iter().all(Option::is_none) { "feet: it lacks " } else { "joint " };
        let joints = listed(skeleton);
        let message = format!("the skeleton has no {feet}{}; its joints are {joints}", lacking.join(", "));
        Err(LineError::of_file(message))
    }
}

/// Names for a message, cut after forty.
pub(super) fn listed(names: &[&str]) -> String {
    const MOST: usize = 40;
    let shown: Vec<String> = names.iter().take(MOST).map(|name| quoted(name)).collect();
    format!("{}{}", shown.join(", "), if names.len() > MOST { ", …" } else { "" })
}
