//! Extremes of one strain that are pulls: one question has one answer, by whichever door it comes.
//!
//! The largest E_DD, with E_⊥⊥ held and no shear, is the pull along D with l2 = √(1 + 2 E_⊥⊥) − 1; E_DD = l1 + l1²/2 grows with l1.
//! With the width free, or width and shear, it is the pull that leaves them free. The least E_DD is the compression likewise. Then
//! the limit is found as a map finds it. All other questions go to [`StrainMethod`].

use super::{ExactOptions, Method, image, symmetric_chains};
use crate::{
    constraint::{Contact, metric::factor},
    error::InvalidInput,
    lattice::{Across, direction},
    limit::{
        CellTrend, LimitOutcome,
        exact::ExactMethod,
        strain::{Strain, StrainMethod, StrainOptions, StrainOutcome, StrainQuery},
    },
    model::Model,
    record::Status,
    state::{Pose, State},
};
use maille_geometry::Vec3;
use nalgebra::{Matrix2, Rotation3, UnitQuaternion};
use std::sync::atomic::AtomicBool;

/// One strain as large or as small as can be.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainQuestion {
    /// The strain that is sought.
    pub goal: Strain,
    /// 1 for its largest value, −1 for its least.
    pub sign: f64,
    /// Strains that are held.
    pub fix: Vec<(Strain, f64)>,
    /// Strains that are left to the sheet; those that are neither are held at 0.
    pub free: Vec<Strain>,
    /// Direction of the strains' x axis, in degrees.
    pub direction_deg: f64,
    /// Starts in place of those that the method takes by itself.
    pub starts: Option<usize>,
    /// Seed of the shaking.
    pub seed: u64,
}

/// A pull in place of a question on strains.
struct AsPull {
    direction_deg: f64,
    l2: f64,
    across: Across,
}

impl StrainQuestion {
    /// The query in the space of strains. Refused where a strain is named twice or no lattice has what is held.
    pub fn query(&self) -> Result<StrainQuery, InvalidInput> {
        StrainQuery::of(self.goal, self.sign, &self.fix, &self.free, self.direction_deg)
    }

    /// The answer, on one design compiled for cells of growing size. Refused as [`Self::query`] is.
    pub fn answer(&self, models: &[Model], cancel: &AtomicBool) -> Result<StrainOutcome, InvalidInput> {
        let query = self.query()?;
        if let Some(found) = self.as_pull().and_then(|pull| self.pulled(models, &pull, &query, cancel)) {
            return Ok(found);
        }
        let method = StrainMethod::new(models, self.options());
        Ok(method.solve(&query, &[], cancel))
    }

    fn options(&self) -> StrainOptions {
        let StrainOptions { starts, .. } = StrainOptions::default();
        StrainOptions { starts: self.starts.unwrap_or(starts), seed: self.seed, compression: self.sign < 0.0 }
    }

    /// The pull that asks the same, if one does.
    fn as_pull(&self) -> Option<AsPull> {
        let (side, turn_deg) = match self.goal {
            Strain::Exx => (Strain::Eyy, 0.0),
            Strain::Eyy => (Strain::Exx, 90.0),
            Strain::Exy => return None,
        };
        let held =
            |strain: Strain| self.fix.iter().find(|(named, _)| *named == strain).map_or(0.0, |(_, value)| *value);
        let across = Across { lateral_free: self.free.contains(&side), shear_free: self.free.contains(&Strain::Exy) };
        // With the width held and the shear free, a pull holds the stretch across it and not E.
        let a_pull = held(Strain::Exy) == 0.0 && (across.lateral_free || !across.shear_free);
        let l2 = if across.lateral_free { 0.0 } else { (1.0 + 2.0 * held(side)).sqrt() - 1.0 };
        a_pull.then_some(AsPull { direction_deg: self.direction_deg + turn_deg, l2, across })
    }

    /// The limit of the pull as the answer; `None` where its state is of a cell that is none of `models`.
    fn pulled(
        &self,
        models: &[Model],
        pull: &AsPull,
        query: &StrainQuery,
        cancel: &AtomicBool,
    ) -> Option<StrainOutcome> {
        let ExactOptions { starts, .. } = ExactOptions::default();
        let starts = self.starts.unwrap_or(starts);
        let options = ExactOptions { starts, seed: self.seed, across: pull.across, compression: self.sign < 0.0 };
        let method = Method::Exact(options.clone());
        let (operations, chains) = symmetric_chains(&models[0], &method, &[pull.direction_deg]);
        let solved_deg = chains[0].representative_deg;
        let mut limit = None;
        ExactMethod::new(models, options, cancel)
            .limits(solved_deg, &[pull.l2], cancel, &mut |_, found| limit = Some(found));
        let mut limit = limit?;
        if solved_deg != pull.direction_deg {
            let image = image::image(&operations, models, &limit, solved_deg, pull.direction_deg);
            let cell = models.iter().position(|model| model.cell == image.model.cell)?;
            limit = image.outcome;
            if let Some(figures) = &mut limit.exact {
                figures.cell = cell;
            }
        }
        let mut out = answer(models, self.sign, pull, query, limit);
        if let (Some(value), Status::Global | Status::Local) = (out.value, out.status) {
            StrainMethod::new(models, self.options()).ranges(query, value, &mut out, cancel);
        }
        Some(out)
    }
}

/// E_DD at a stretch of 1 + l1 along D.
fn green(l1: f64) -> f64 {
    l1 + 0.5 * l1 * l1
}

fn answer(models: &[Model], sign: f64, pull: &AsPull, query: &StrainQuery, limit: LimitOutcome) -> StrainOutcome {
    let figures = limit.exact.unwrap_or_default();
    let model = &models[figures.cell];
    let f = limit.gradient;
    let e = (f.transpose() * f - Matrix2::identity()) * 0.5;
    let along = direction(pull.direction_deg);
    let solved = matches!(limit.status, Status::Global | Status::Local | Status::Uncertified);
    let l1 = along.dot(&(f * along)) - 1.0;
    // The lattice of an answer has the triangular factor of C.
    let turned = factor(&(f.transpose() * f)).zip(f.try_inverse()).filter(|_| solved);
    let turn = turned.map_or(Matrix2::identity(), |(triangular, inverse)| triangular * inverse);
    let turn = Rotation3::from_axis_angle(&Vec3::z_axis(), turn[(1, 0)].atan2(turn[(0, 0)]));
    let pose = |pose: &Pose| Pose {
        position: turn * pose.position,
        rotation: UnitQuaternion::from_rotation_matrix(&turn) * pose.rotation,
    };
    let State { poses, a1, a2 } = &limit.state;
    let state = State { poses: poses.iter().map(pose).collect(), a1: turn * a1, a2: turn * a2 };
    // dE = (1 + l1) dl1.
    let contact = |c: &Contact| Contact {
        point_a: turn * c.point_a,
        point_b: turn * c.point_b,
        force: c.force * (1.0 + l1),
        ..*c
    };
    let certified = matches!(limit.status, Status::Global | Status::Local);
    // Of the least strain −E_DD is maximised.
    let value = |l1: f64| sign * green(l1);
    let trend = |t: &CellTrend| CellTrend { value: t.value.map(value), ..*t };
    let trend: Vec<CellTrend> = figures.trend.iter().map(trend).collect();
    let alone = CellTrend {
        cell: figures.cell,
        value: certified.then(|| value(l1)),
        n_starts: figures.n_starts,
        n_distinct: figures.n_distinct,
    };
    StrainOutcome {
        status: limit.status,
        value: solved.then(|| value(l1)),
        first: None,
        bound: figures.bound.map(|(l1, _)| value(l1)),
        strain: if solved { e } else { query.held },
        ranges: Vec::new(),
        state: if solved { state } else { model.start.clone() },
        cell: figures.cell,
        certificate: figures.certificate,
        contacts: figures.contacts.iter().map(contact).collect(),
        links_ok: figures.links_ok.unwrap_or(false),
        own_image_force: figures.own_image_force.unwrap_or(0.0) * (1.0 + l1),
        n_starts: figures.n_starts,
        n_distinct: figures.n_distinct,
        trend: if trend.is_empty() { vec![alone] } else { trend },
        iterations: limit.iterations,
    }
}
