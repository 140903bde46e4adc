//! Neighbour lists (Verlet lists): one list of column indices for each group of eight particles stored in
//! sequence. Lists are kept until two particles have approached each other by more than the skin.
//!
//! Particles are stored in tiles 64 spacings wide, so that the neighbours of a group are in the nearest
//! caches. In a tile they follow strips two spacings high, every other strip backwards, so that a group is
//! compact: four by two on a square lattice, where 60 columns are within three spacings of the group and 28
//! within three spacings of one particle.
//!
//! Column c < n is particle c; then follow images (periodic copies, mirror particles), and last the sentinel,
//! which fills the empty lanes of a group. Two particles farther apart than support + skin when the lists
//! were built, and since then no nearer by more than the skin, are outside each other's support: the
//! criterion is exact.
//!
//! A list begins with the members of its group, then the columns inside the support of any member. Columns
//! outside every support are at its end, where a pair sweep skips them, so that a wide skin costs little.

use std::{mem::take, ops::Range};

use crate::lane::{Lane, MOST, OnLanes, gather_vector, on_widest};
use nalgebra::Vector2;

use crate::{
    domain::Domain,
    numbers::Numbers,
    parallel,
    particles::SweptParticle,
    walls::{Map, PlaneWall, corners},
};

/// Particles in a unit of parallel work; fixed, so that nothing depends on the number of threads.
pub(crate) const BLOCK: usize = 512;

/// An extra column: a copy of an earlier column (a particle or an image) by a map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image {
    pub source: u32,
    pub map: u32,
}

/// Cells, two spacings wide, side by side in a tile.
const TILE: usize = 32;

/// The lists of up to [`BLOCK`] particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct ListBlock {
    /// The list of group g of the block is `columns[starts[g]..starts[g + 1]]`.
    starts: Vec<u32>,
    columns: Vec<u32>,
    /// Scratch: columns that may be in one list.
    found: Vec<u32>,
    /// Scratch: columns of one list that are beyond the support.
    beyond: Vec<u32>,
    /// Neighbours of particles inside the support when the lists were built.
    pub pairs: u64,
}

/// Particles that share a list: the number of lanes of the widest registers, on every processor, so that bits
/// do not depend on the processor.
pub const GROUP: usize = MOST;

impl ListBlock {
    /// The list of a group of the block.
    #[inline(always)]
    pub fn list(&self, group: usize) -> &[u32] {
        &self.columns[self.starts[group] as usize..self.starts[group + 1] as usize]
    }

    fn bytes(&self) -> usize {
        let Self { starts, columns, found, beyond, .. } = self;
        [starts, columns, found, beyond].map(Vec::capacity).iter().sum::<usize>() * size_of::<u32>()
    }
}

/// The neighbour lists of particles that are stored one after another.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lists {
    pub of: Range<usize>,
    /// Whether blocks are worth spreading over threads.
    pub parallel: bool,
    pub blocks: Vec<ListBlock>,
}

/// The lower and the upper corner of a box \[m\].
type Corners = [Vector2<f64>; 2];

/// The box around a box and points.
fn around(of: Corners, points: &[Vector2<f64>]) -> Corners {
    points.iter().fold(of, |[low, high], p| [low.inf(p), high.sup(p)])
}

/// A grid of cells no smaller than the list radius.
#[derive(Clone, Copy, Debug, Default)]
struct Grid {
    low: Vector2<f64>,
    inverse: Vector2<f64>,
    cells: [usize; 2],
}

impl Grid {
    /// Covers this number of points between two corners, and a margin before the first, by cells of this
    /// size. Cells are enlarged until there are at most about two a point.
    fn new(points: usize, [low, high]: Corners, size_of_cell: f64, margin: f64) -> Self {
        let low = low.map(|low| low - margin);
        let size = high - low;
        let most = (2 * points + 16) as f64;
        // A cell of size 0 would stay so.
        let mut cell = Vector2::repeat(size_of_cell.max(f64::MIN_POSITIVE));
        while (size.x / cell.x + 1.0) * (size.y / cell.y + 1.0) > most {
            // Coarsen along the axis with more cells: few particles far apart, or a long thin set.
            let axis = usize::from(size.y / cell.y > size.x / cell.x);
            cell[axis] *= 2.0;
        }
        let cells = [0, 1].map(|a| (size[a] / cell[a]) as usize + 1);
        Self { low, inverse: cell.map(|c| 1.0 / c), cells }
    }

    /// The column and the row of the cell of a point.
    #[inline(always)]
    fn cell(&self, point: Vector2<f64>) -> [usize; 2] {
        let q = (point - self.low).component_mul(&self.inverse);
        // A float below 0 becomes 0; the upper bound guards against the last bit.
        [0, 1].map(|a| (q[a] as usize).min(self.cells[a] - 1))
    }

    /// The number of the cell of a point, row by row.
    #[inline(always)]
    fn index(&self, point: Vector2<f64>) -> usize {
        let [x, y] = self.cell(point);
        y * self.cells[0] + x
    }

    /// The number of the cell of a point, tile after tile, each row by row, every other row backwards.
    fn along_strips(&self, point: Vector2<f64>) -> usize {
        let [x, y] = self.cell(point);
        let ([tile, along], height) = ([x / TILE, x % TILE], self.cells[1]);
        let along = if y.is_multiple_of(2) { along } else { TILE - 1 - along };
        (tile * height + y) * TILE + along
    }
}

/// The neighbour lists of a scene, and buffers to rebuild them without allocating.
#[derive(Debug, Default)]
pub(crate) struct Neighbours {
    support: f64,
    radius: f64,
    spacing: f64,
    pub domain: Domain,
    /// Whether the work on particles is distributed over threads.
    pub parallel: bool,
    pub maps: Vec<Map>,
    pub images: Vec<Image>,
    /// Ranges of images, one after another, whose sources are particles or images of earlier ranges:
    /// mirror particles, then the periodic copies along each axis.
    stages: Vec<Range<usize>>,
    /// Lists of the fluid particles.
    pub lists: Lists,
    /// Lists of the wall particles.
    pub wall_lists: Lists,
    /// From each wall particle to the centre of its list \[m\]; empty if the particle itself is the centre.
    pub feet: Vec<Vector2<f64>>,
    /// Positions of the particles when the lists were built.
    pub built_at: Vec<Vector2<f64>>,
    points: Vec<Vector2<f64>>,
    grid: Grid,
    /// Scratch: for each point, the maps that make an image of it, one bit each, or the number of its cell.
    marks: Vec<u32>,
    /// Scratch: the box around each block of points.
    boxes: Vec<Corners>,
    cell_starts: Vec<u32>,
    /// Columns in the order of cells and, while lists are built, their positions; then padding for the last
    /// lanes.
    cell_columns: Vec<u32>,
    cell_points: Vec<Vector2<f64>>,
}

/// Lengths from which neighbour lists are built \[m\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub support: f64,
    /// How far lists reach beyond the support.
    pub skin: f64,
    /// Approximate distance between nearest particles.
    pub spacing: f64,
}

impl Neighbours {
    /// Empty lists.
    pub fn new(reach: Reach, domain: Domain, mirrors: &[PlaneWall]) -> Self {
        let Reach { support, skin, spacing } = reach;
        let radius = support + skin;
        let mut maps: Vec<_> = mirrors.iter().copied().map(Map::Mirror).collect();
        maps.extend(corners(mirrors).map(Map::corner));
        for axis in 0..2 {
            if let Some(period) = domain.period[axis] {
                let shift = if axis == 0 { Vector2::x() } else { Vector2::y() } * period;
                maps.extend([Map::Shift(shift), Map::Shift(-shift)]);
            }
        }
        Self { support, radius, spacing, domain, maps, ..Self::default() }
    }

    /// The walls that mirror.
    pub fn mirrors(&self) -> impl Iterator<Item = &PlaneWall> {
        self.maps.iter().map_while(|map| match map {
            Map::Mirror(wall) => Some(wall),
            _ => None,
        })
    }

    /// Neighbours of all lists that were inside the support when these were built.
    pub fn pairs(&self) -> u64 {
        self.blocks().map(|b| b.pairs).sum()
    }

    fn blocks(&self) -> impl Iterator<Item = &ListBlock> {
        self.lists.blocks.iter().chain(&self.wall_lists.blocks)
    }

    /// The particle that a column copies, however often; of the sentinel itself.
    pub fn particle(&self, column: usize) -> usize {
        let image = column.checked_sub(self.built_at.len()).and_then(|k| self.images.get(k));
        image.map_or(column, |image| self.particle(image.source as usize))
    }

    /// Memory held \[bytes\].
    pub fn bytes(&self) -> usize {
        let points =
            [&self.feet, &self.built_at, &self.points, &self.cell_points].map(Vec::capacity);
        let numbers = [&self.marks, &self.cell_starts, &self.cell_columns].map(Vec::capacity);
        self.blocks().map(ListBlock::bytes).sum::<usize>()
            + self.images.capacity() * size_of::<Image>()
            + points.into_iter().sum::<usize>() * size_of::<Vector2<f64>>()
            + numbers.into_iter().sum::<usize>() * size_of::<u32>()
            + self.boxes.capacity() * size_of::<Corners>()
    }

    /// Takes note of where `count` particles are, for [`Neighbours::order`] or [`Neighbours::build`].
    pub fn place(&mut self, count: usize, at: &(dyn Fn(usize) -> Vector2<f64> + Sync)) {
        self.points.resize(count, Vector2::zeros());
        parallel::for_each_part(&mut self.points, self.parallel, &|first, points| {
            points.iter_mut().zip(first..).for_each(|(point, k)| *point = at(k));
        });
    }

    /// The box around all points.
    fn corners(&mut self) -> Corners {
        let Self { points, boxes, .. } = self;
        boxes.resize(points.len().div_ceil(BLOCK), Corners::default());
        let blocks = points.chunks(BLOCK).zip(&mut *boxes);
        parallel::for_each(blocks, self.parallel, &|(points, of)| {
            *of = around([points[0]; 2], points);
        });
        boxes.iter().fold(boxes[0], |of, other| around(of, other))
    }

    /// The order along strips two spacings high, every other one backwards. The result does not depend on the
    /// order of the placed particles.
    pub fn order(&mut self, order: &mut Vec<u32>) {
        let (count, corners) = (self.points.len(), self.corners());
        let grid = Grid::new(count, corners, 2.0 * self.spacing, 0.5 * self.spacing);
        let [width, height] = grid.cells;
        let cells = width.next_multiple_of(TILE) * height;
        self.sort_by_cell(cells, &|p| grid.along_strips(p));
        let Self { points, cell_starts: starts, cell_columns, .. } = self;
        // Eight rows of a tile are some 1000 particles.
        const STRETCH: usize = 8 * TILE;
        let mut rest = &mut cell_columns[..count];
        let stretches = (0..cells).step_by(STRETCH).map(|first| {
            let starts = &starts[first..=(first + STRETCH).min(cells)];
            let (columns, after) =
                take(&mut rest).split_at_mut((starts[starts.len() - 1] - starts[0]) as usize);
            rest = after;
            (first, starts, columns)
        });
        parallel::for_each(stretches, self.parallel, &|(first, starts, columns)| {
            for (cell, ends) in (first..).zip(starts.windows(2)) {
                let backwards = !(cell / TILE % height).is_multiple_of(2);
                let [start, end] = [ends[0], ends[1]].map(|end| (end - starts[0]) as usize);
                columns[start..end].sort_unstable_by(|&a, &b| {
                    let [a, b] = [a, b].map(|column| points[column as usize]);
                    let along = a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
                    if backwards { along.reverse() } else { along }
                });
            }
        });
        order.clear();
        order.extend_from_slice(&self.cell_columns[..count]);
    }

    /// Builds the lists of the first `fluid` placed particles and of the `wall` ones after them. With
    /// `fluid_only` the lists of the latter list fluid particles and their images alone.
    pub fn build(&mut self, fluid: usize, wall: usize, fluid_only: bool) {
        parallel::copy(&self.points, &mut self.built_at, self.parallel);
        let (real, corners) = (self.points.len(), self.corners());
        self.make_images(corners);
        let corners = around(corners, &self.points[real..]);
        let grid = Grid::new(self.points.len(), corners, self.radius, 0.0);
        self.grid = grid;
        self.sort_by_cell(grid.cells[0] * grid.cells[1], &|p| grid.index(p));
        let [lists, wall_lists] = [take(&mut self.lists), take(&mut self.wall_lists)];
        let up_to = if fluid_only { fluid } else { usize::MAX };
        self.lists = self.fill(lists, 0..fluid, usize::MAX);
        for (point, foot) in self.points[fluid..].iter_mut().zip(&self.feet) {
            *point += foot;
        }
        self.wall_lists = self.fill(wall_lists, fluid..fluid + wall, up_to);
    }

    /// Appends the images within reach: ghosts of particles near a wall or a corner, then along each
    /// axis the periodic copies of all of these. Maps are used in the order of [`Neighbours::new`]. The
    /// particles are between two corners.
    fn make_images(&mut self, [low, high]: Corners) {
        self.images.clear();
        self.stages.clear();
        let mirrors = self.maps.partition_point(|map| !map.walls().is_empty());
        let radius = self.radius;
        self.make_stage(0..mirrors, &|map, point| {
            map.walls().iter().all(|wall| wall.depth(point).abs() < radius)
        });
        let mut first = mirrors;
        for axis in 0..2 {
            let Some(period) = self.domain.period[axis] else { continue };
            self.make_stage(first..first + 2, &|map, point| match map {
                Map::Shift(by) if by[axis] > 0.0 => point[axis] + period < high[axis] + radius,
                _ => point[axis] - period > low[axis] - radius,
            });
            first += 2;
        }
    }

    /// Appends the images of all points so far, by the maps that are `near` the point.
    fn make_stage(
        &mut self,
        maps: Range<usize>,
        near: &(dyn Fn(&Map, Vector2<f64>) -> bool + Sync),
    ) {
        let (start, count) = (self.images.len(), self.points.len());
        if maps.is_empty() {
            return;
        }
        let Self { marks, points, maps: all, .. } = self;
        marks.resize(count, 0);
        let bit = |(k, map): (usize, &Map), point| u32::from(near(map, point)) << k;
        parallel::for_each_pair(marks, points, self.parallel, &|mark, point| {
            let bits = all[maps.clone()].iter().enumerate().map(|map| bit(map, *point));
            *mark = bits.fold(0, |mark, bit| mark | bit);
        });
        for source in 0..count {
            let mut left = self.marks[source];
            while left != 0 {
                let map = maps.start + left.trailing_zeros() as usize;
                let place = self.maps[map].place(self.points[source]);
                self.images.push(Image { source: source as u32, map: map as u32 });
                self.points.push(place);
                left &= left - 1;
            }
        }
        self.stages.push(start..self.images.len());
    }

    /// Writes the columns of the images whose sources are particle `first` or a later one: `image` from the
    /// map and the source.
    pub fn fill_images<D: Numbers>(
        &self,
        first: usize,
        columns: &mut [SweptParticle<D>],
        image: &(impl Fn(&Map, &SweptParticle<D>) -> SweptParticle<D> + Sync),
    ) {
        let real = columns.len() - 1 - self.images.len();
        for stage in &self.stages {
            let (sources, targets) = columns.split_at_mut(real + stage.start);
            let images = &self.images[stage.clone()];
            parallel::for_each_pair(targets, images, self.parallel, &|target, of| {
                let source = of.source as usize;
                if source >= first {
                    *target = image(&self.maps[of.map as usize], &sources[source]);
                }
            });
        }
    }

    /// Counting sort of all columns by the number of their cell, stable.
    fn sort_by_cell(&mut self, cells: usize, number: &(dyn Fn(Vector2<f64>) -> usize + Sync)) {
        let Self { points, marks, cell_starts: starts, parallel, .. } = self;
        marks.resize(points.len(), 0);
        parallel::for_each_pair(marks, points, *parallel, &|mark, point| {
            *mark = number(*point) as u32;
        });
        starts.clear();
        starts.resize(cells + 1, 0);
        marks.iter().for_each(|cell| starts[*cell as usize + 1] += 1);
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        self.cell_columns.resize(points.len() + GROUP, 0);
        self.cell_points.resize(points.len() + GROUP, Vector2::zeros());
        for (column, cell) in marks.iter().enumerate() {
            let slot = &mut starts[*cell as usize];
            self.cell_columns[*slot as usize] = column as u32;
            *slot += 1;
        }
        // Each entry now holds the end of its cell, the start of the next one.
        starts.rotate_right(1);
        starts[0] = 0;
        let columns = &self.cell_columns[..points.len()];
        parallel::for_each_pair(&mut self.cell_points, columns, *parallel, &|point, column| {
            *point = points[*column as usize];
        });
    }

    /// The lists of particles `of`, which list columns of the particles before `up_to` alone.
    fn fill(&self, mut lists: Lists, of: Range<usize>, up_to: usize) -> Lists {
        lists.blocks.resize_with(of.len().div_ceil(BLOCK), ListBlock::default);
        parallel::for_each(lists.blocks.iter_mut().enumerate(), self.parallel, &|(b, block)| {
            let start = of.start + b * BLOCK;
            let of = start..(start + BLOCK).min(of.end);
            on_widest(FillLists { neighbours: self, block, of, up_to });
        });
        Lists { of, parallel: self.parallel, ..lists }
    }

    /// Finds the columns nearer than the radius to the bounding box of these particles, in the order of
    /// cells, then of columns. Returns their number.
    #[inline(always)]
    fn find<V: Lane>(&self, found: &mut Vec<u32>, of: Range<usize>) -> usize {
        const { assert!(GROUP.is_multiple_of(V::LANES)) };
        let members = &self.points[of];
        let low = members.iter().fold(members[0], |a, p| a.inf(p));
        let high = members.iter().fold(members[0], |a, p| a.sup(p));
        let ([left, bottom], [right, top]) = (self.grid.cell(low), self.grid.cell(high));
        let (low, high) = (low.spread::<V>(), high.spread::<V>());
        let (radius2, [width, height]) = (self.radius * self.radius, self.grid.cells);
        let mut count = 0;
        for y in bottom.saturating_sub(1)..(top + 2).min(height) {
            let start = self.cell_starts[y * width + left.saturating_sub(1)] as usize;
            let end = self.cell_starts[y * width + (right + 2).min(width)] as usize;
            found.resize(found.len().max(count + end - start + V::LANES), 0);
            let run = start..start + (end - start).next_multiple_of(V::LANES);
            let points = self.cell_points[run.clone()].chunks_exact(V::LANES);
            let columns = self.cell_columns[run].chunks_exact(V::LANES);
            for (k, (points, columns)) in points.zip(columns).enumerate() {
                let place = gather_vector::<V>(|lane| points[lane]);
                // Rounded like the distance to a particle, and monotonic: never above it.
                let x = (low.x - place.x).at_least(place.x - high.x).positive();
                let y = (low.y - place.y).at_least(place.y - high.y).positive();
                // The last lanes may be of the next cells.
                let of_the_run = !(!0 << (end - start - k * V::LANES).min(V::LANES));
                let bits = (x * x + y * y).bits_below(radius2) & of_the_run;
                count += V::pack(columns, bits, &mut found[count..]);
            }
        }
        count
    }
}

/// Builds the lists of one block.
struct FillLists<'a> {
    neighbours: &'a Neighbours,
    block: &'a mut ListBlock,
    of: Range<usize>,
    up_to: usize,
}

/// The particles of a group.
struct Group<V> {
    /// One entry for each lane.
    members: [Vector2<V>; GROUP],
    support2: f64,
    radius2: f64,
}

/// The members of a group near a point: bit k is member k.
struct Near {
    inside_support: usize,
    listed: usize,
}

impl<V: Lane> Group<V> {
    #[inline(always)]
    fn new(neighbours: &Neighbours, members: Range<usize>) -> Self {
        let &Neighbours { support, radius, ref points, .. } = neighbours;
        let points = &points[members];
        // No point is near a place that is NaN.
        let nowhere = Vector2::repeat(f64::NAN);
        let point = |k: usize| points.get(k).copied().unwrap_or(nowhere);
        let mut members = [nowhere.spread::<V>(); GROUP];
        for (k, members) in members.iter_mut().enumerate().take(GROUP / V::LANES) {
            *members = gather_vector::<V>(|lane| point(k * V::LANES + lane));
        }
        Self { members, support2: support * support, radius2: radius * radius }
    }

    /// The members within the support of a point, and within the radius of lists.
    #[inline(always)]
    fn near(&self, point: Vector2<f64>) -> Near {
        let point = point.spread::<V>();
        let mut near = Near { inside_support: 0, listed: 0 };
        for (k, members) in self.members.iter().enumerate().take(GROUP / V::LANES) {
            let r = members - point;
            let r2 = r.x * r.x + r.y * r.y;
            near.inside_support |= r2.bits_below(self.support2) << (k * V::LANES);
            near.listed |= r2.bits_below(self.radius2) << (k * V::LANES);
        }
        near
    }
}

impl OnLanes for FillLists<'_> {
    #[inline(always)]
    fn run<V: Lane>(self) {
        let Self { neighbours, block, of, up_to } = self;
        let points = &neighbours.points;
        let ListBlock { starts, columns, found, beyond, .. } = block;
        starts.clear();
        starts.push(0);
        columns.clear();
        block.pairs = 0;
        for first in of.clone().step_by(GROUP) {
            let members = first..(first + GROUP).min(of.end);
            let count = neighbours.find::<V>(found, members.clone());
            // Not a closure: closures are not inlined here, see the profiles in `Cargo.toml`.
            let group = Group::<V>::new(neighbours, members.clone());
            if of.end <= up_to {
                for (lane, member) in members.clone().enumerate() {
                    columns.push(member as u32);
                    let others = group.near(points[member]).inside_support & !(1_usize << lane);
                    block.pairs += u64::from(others.count_ones());
                }
            }
            let mut end = columns.len();
            columns.resize(end + count, 0);
            beyond.resize(beyond.len().max(count), 0);
            let mut far = 0;
            for &column in &found[..count] {
                let k = column as usize;
                if members.contains(&k) || (up_to < usize::MAX && neighbours.particle(k) >= up_to) {
                    continue;
                }
                let Near { inside_support: inside, listed } = group.near(points[k]);
                // Always written, counted only if kept: no branch to mispredict.
                (columns[end], beyond[far]) = (column, column);
                end += usize::from(inside != 0);
                far += usize::from(inside == 0 && listed != 0);
                block.pairs += u64::from(inside.count_ones());
            }
            columns.truncate(end);
            columns.extend_from_slice(&beyond[..far]);
            starts.push(columns.len() as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::lane::Portable;

    use super::*;
    use crate::random::random;

    /// A point of the rectangle of this size from the origin.
    fn point(random: &mut impl FnMut() -> f64, [width, height]: [f64; 2]) -> Vector2<f64> {
        Vector2::new((random() + 0.5) * width, (random() + 0.5) * height)
    }

    /// An entry of a list: the particle, and the position of the particle or of its image.
    type Listed = (u32, Vector2<f64>);

    fn horizontal(y: f64, up: f64) -> PlaneWall {
        PlaneWall::new(Vector2::new(0.0, y), Vector2::new(0.0, up), Vector2::zeros())
    }

    /// All neighbours of particle i within `radius`, found by trying every image; shifts of two periods are
    /// included to show that one period is enough.
    fn brute_force(
        points: &[Vector2<f64>],
        i: usize,
        radius: f64,
        domain: &Domain,
        mirrors: &[PlaneWall],
    ) -> Vec<Listed> {
        let shifts = |axis: usize| match domain.period[axis] {
            Some(period) => (-2..=2).map(|k| f64::from(k) * period).collect(),
            None => vec![0.0],
        };
        let mut seen = Vec::new();
        for (j, &point) in points.iter().enumerate() {
            let across = |w: &PlaneWall, point: Vector2<f64>| {
                point - w.normal * (2.0 * (point - w.point).dot(&w.normal))
            };
            let mirrored = mirrors.iter().map(|w| across(w, point));
            let square = |a: &PlaneWall, b: &PlaneWall| a.normal.dot(&b.normal) == 0.0;
            let pairs = (0..mirrors.len()).flat_map(|a| (0..a).map(move |b| [a, b]));
            let pairs = pairs.map(|ab| ab.map(|k| &mirrors[k])).filter(|[a, b]| square(a, b));
            let twice = pairs.map(|[a, b]| across(a, across(b, point)));
            for (m, place) in std::iter::once(point).chain(mirrored).chain(twice).enumerate() {
                for (sx, sy) in
                    shifts(0).into_iter().flat_map(|x| shifts(1).into_iter().map(move |y| (x, y)))
                {
                    let own = m == 0 && j == i && sx == 0.0 && sy == 0.0;
                    let place = place + Vector2::new(sx, sy);
                    if !own && (place - points[i]).norm() < radius {
                        seen.push((j as u32, place));
                    }
                }
            }
        }
        seen
    }

    /// The neighbours of particle `own`, number k of these blocks, and of its group.
    fn listed(
        neighbours: &Neighbours,
        blocks: &[ListBlock],
        k: usize,
        points: &[Vector2<f64>],
        own: usize,
    ) -> Vec<Listed> {
        let list = blocks[k / BLOCK].list(k % BLOCK / GROUP).iter();
        let others = list.filter(|&&c| c as usize != own);
        others.map(|&c| seen(neighbours, points, c)).collect()
    }

    /// The particle that a column copies, however often, and where the column is.
    fn seen(neighbours: &Neighbours, points: &[Vector2<f64>], column: u32) -> Listed {
        let Some(k) = (column as usize).checked_sub(points.len()) else {
            return (column, points[column as usize]);
        };
        let Image { source, map } = neighbours.images[k];
        let (particle, place) = seen(neighbours, points, source);
        (particle, neighbours.maps[map as usize].place(place))
    }

    /// Whether each entry of one list is in the other, as often.
    fn same(mut a: Vec<Listed>, mut b: Vec<Listed>, tolerance: f64) -> bool {
        let by_source_then_place = |p: &Listed, q: &Listed| {
            let key = |s: &Listed| (s.0, (s.1 / (1e3 * tolerance)).map(|x| x.round() as i64));
            let (p, q) = (key(p), key(q));
            (p.0, p.1.x, p.1.y).cmp(&(q.0, q.1.x, q.1.y))
        };
        a.sort_by(by_source_then_place);
        b.sort_by(by_source_then_place);
        let close = |(p, q): (&Listed, &Listed)| p.0 == q.0 && (p.1 - q.1).amax() < tolerance;
        a.len() == b.len() && a.iter().zip(&b).all(close)
    }

    fn check(points: &[Vector2<f64>], radius: f64, domain: &Domain, mirrors: &[PlaneWall]) -> u64 {
        let reaches = Reach { support: 0.75 * radius, skin: 0.25 * radius, spacing: 0.1 };
        let mut neighbours = Neighbours::new(reaches, *domain, mirrors);
        let n = points.len();
        let all: Vec<_> = (0..n).map(|i| brute_force(points, i, radius, domain, mirrors)).collect();
        let mut pairs = 0;
        // The last points are walls that list all columns, walls that list fluid only, or not walls.
        for (fluid, fluid_only) in [(n / 2, false), (n / 2, true), (n, false)] {
            neighbours.place(points.len(), &|k| points[k]);
            neighbours.build(fluid, n - fluid, fluid_only);
            pairs = 0;
            let mut inside = 0;
            for (i, expected) in all.iter().enumerate() {
                let (lists, k) = match i.checked_sub(fluid) {
                    None => (&neighbours.lists, i),
                    Some(k) => (&neighbours.wall_lists, k),
                };
                let members = i - k % GROUP..(i - k % GROUP + GROUP).min(lists.of.end);
                let mut expected = expected.clone();
                expected.retain(|(j, _)| !fluid_only || i < fluid || (*j as usize) < fluid);
                let wanted = expected.len();
                pairs += wanted as u64;
                let mut found = listed(&neighbours, &lists.blocks, k, points, i);
                let is_member = |e: &&Listed| members.clone().any(|m| *e == &(m as u32, points[m]));
                let lead = found.iter().take_while(is_member).count();
                let to_group = |e: &Listed| {
                    let distances = points[members.clone()].iter().map(|p| (e.1 - p).norm());
                    distances.fold(f64::MAX, f64::min)
                };
                let others = &found[lead..];
                assert!(
                    others.is_sorted_by_key(|e| to_group(e) >= reaches.support),
                    "the near ones first"
                );
                assert!(others.iter().all(|e| to_group(e) < radius), "no one that none can see");
                found.retain(|e| (e.1 - points[i]).norm() < radius);
                let near = found.iter().filter(|e| (e.1 - points[i]).norm() < reaches.support);
                inside += near.count() as u64;
                assert!(
                    same(found, expected, 1e-9),
                    "list {i} of {n}: {wanted} neighbours expected"
                );
            }
            assert_eq!(neighbours.pairs(), inside, "only what is inside the support is counted");
        }
        // The parallel path builds the same lists in the same order.
        let mut parallel = Neighbours::new(reaches, *domain, mirrors);
        parallel.parallel = true;
        parallel.place(n, &|k| points[k]);
        parallel.build(n, 0, false);
        for (a, b) in neighbours.lists.blocks.iter().zip(&parallel.lists.blocks) {
            assert_eq!((&a.starts, &a.columns), (&b.starts, &b.columns));
        }
        pairs
    }

    /// With four-lane registers this is other code.
    #[test]
    fn lists_are_the_same_in_portable_lanes() {
        let (mut random, domain) = (random(3), Domain::torus(4.0, 3.0));
        let points: Vec<_> = (0..500).map(|_| point(&mut random, [4.0, 3.0])).collect();
        let mut neighbours =
            Neighbours::new(Reach { support: 0.5, skin: 0.1, spacing: 0.15 }, domain, &[]);
        neighbours.place(points.len(), &|k| points[k]);
        neighbours.build(250, 250, true);
        let [fluid, wall] =
            [&neighbours.lists, &neighbours.wall_lists].map(|lists| &lists.blocks[..]);
        for (built, of, up_to) in [(fluid, 0..250, usize::MAX), (wall, 250..500, 250)] {
            let [mut portable, mut widest] = [ListBlock::default(), ListBlock::default()];
            let of_block =
                |block| FillLists { neighbours: &neighbours, block, of: of.clone(), up_to };
            of_block(&mut portable).run::<Portable>();
            on_widest(of_block(&mut widest));
            let [built] = built else { panic!("one block") };
            for block in [portable, widest] {
                assert_eq!(block.columns, built.columns);
                assert_eq!((block.starts, block.pairs), (built.starts.clone(), built.pairs));
            }
        }
        assert!(wall[0].pairs > 1000 && fluid[0].pairs > wall[0].pairs);
    }

    #[test]
    fn lists_of_random_points_are_those_of_brute_force_in_every_kind_of_domain() {
        let walls = [horizontal(0.0, 1.0), horizontal(3.0, -1.0)];
        let slanted = PlaneWall::new(Vector2::zeros(), Vector2::new(0.6, 0.8), Vector2::zeros());
        let corner = PlaneWall::new(Vector2::zeros(), Vector2::new(1.0, 0.0), Vector2::zeros());
        let end = Vector2::new(4.0, 0.0);
        let side = PlaneWall::new(end, Vector2::new(-1.0, 0.0), Vector2::zeros());
        let shifted = Domain { low: Vector2::new(-1.0, 7.0), ..Domain::torus(4.0, 3.0) };
        for seed in 0..2 {
            let mut random = random(seed);
            let points: Vec<_> = (0..520).map(|_| point(&mut random, [4.0, 3.0])).collect();
            for radius in [0.05, 0.31, 0.9] {
                check(&points, radius, &Domain::open(), &[]);
                check(&points, radius, &Domain::channel(4.0), &[]);
                check(&points, radius, &Domain::torus(4.0, 3.0), &[]);
                check(&points, radius, &Domain::channel(4.0), &walls);
                check(&points, radius, &Domain::open(), &[slanted]);
                check(&points, radius, &Domain::open(), &[walls[0], corner]);
                check(&points, radius, &Domain::open(), &[walls[0], corner, side, walls[1]]);
                let wrapped: Vec<_> = points.iter().map(|p| shifted.wrap(*p)).collect();
                check(&wrapped, radius, &shifted, &[]);
            }
        }
    }

    #[test]
    fn lists_reach_across_a_period_of_just_two_radii_and_past_its_edges() {
        let mut random = random(9);
        let domain = Domain::torus(2.0, 2.0);
        // Between two wraps particles may be outside the period by a few displacements.
        let outside = Vector2::repeat(0.2);
        let points: Vec<_> = (0..150).map(|_| point(&mut random, [2.4, 2.4]) - outside).collect();
        check(&points, 1.0, &domain, &[]);
    }

    #[test]
    fn lists_of_awkward_sets_are_those_of_brute_force() {
        let mut random = random(3);
        let open = Domain::open();
        let mut clustered: Vec<_> = (0..400).map(|_| point(&mut random, [1e-3, 1e-3])).collect();
        clustered.extend((0..200).map(|_| point(&mut random, [50.0, 50.0])));
        check(&clustered, 0.3, &open, &[]);
        let along = |axis: usize| {
            move |k: i32| {
                let mut point = Vector2::repeat(-3.0);
                point[axis] += 0.7 * f64::from(k);
                point
            }
        };
        for axis in 0..2 {
            let line: Vec<_> = (0..700).map(along(axis)).collect();
            assert_eq!(check(&line, 1.5, &open, &[]), 4 * 700 - 6);
        }
        let one = [Vector2::new(0.5, 0.1)];
        assert_eq!(check(&one, 0.4, &open, &[]), 0);
        assert_eq!(check(&one, 0.4, &Domain::torus(0.8, 0.8), &[]), 0);
        // Its ghost is its only neighbour.
        assert_eq!(check(&one, 0.4, &open, &[horizontal(0.0, 1.0)]), 1);
        let apart = [Vector2::zeros(), Vector2::new(1e6, -1e6)];
        assert_eq!(check(&apart, 2.0, &open, &[]), 0);
        let coincident = [Vector2::repeat(0.3); 9];
        assert_eq!(check(&coincident, 0.1, &Domain::torus(1.0, 1.0), &[]), 72);
    }

    /// True pairs, within `support`, that lists kept over random moves do not list. Lists are rebuilt
    /// when a particle has moved by more than `share` of the skin.
    fn lost(share: f64, builds: &mut u32) -> usize {
        let (support, skin) = (0.4, 0.08);
        let domain = Domain::channel(3.0);
        let mirrors = [horizontal(0.0, 1.0), horizontal(2.0, -1.0)];
        let mut random = random(77);
        let mut points: Vec<_> = (0..200).map(|_| point(&mut random, [3.0, 2.0])).collect();
        let mut neighbours =
            Neighbours::new(Reach { support, skin, spacing: 0.17 }, domain, &mirrors);
        let mut lost = 0;
        let n = points.len();
        neighbours.place(points.len(), &|k| points[k]);
        neighbours.build(n, 0, false);
        for _ in 0..60 {
            for point in &mut points {
                *point += Vector2::new(random(), random()) * 0.03;
                point.y = point.y.clamp(0.0, 2.0);
            }
            let moved = points.iter().zip(&neighbours.built_at).map(|(p, b)| (p - b).norm());
            if moved.fold(0.0, f64::max) > share * skin {
                neighbours.place(points.len(), &|k| points[k]);
                neighbours.build(n, 0, false);
                *builds += 1;
            }
            for i in 0..n {
                let found = listed(&neighbours, &neighbours.lists.blocks, i, &points, i);
                lost += brute_force(&points, i, support, &domain, &mirrors)
                    .iter()
                    .filter(|e| !found.iter().any(|f| f.0 == e.0 && (f.1 - e.1).amax() < 1e-9))
                    .count();
            }
        }
        lost
    }

    #[test]
    fn lists_kept_while_nothing_moved_by_half_the_skin_lose_no_pair() {
        let mut builds = 0;
        assert_eq!(lost(0.5, &mut builds), 0);
        assert!(
            (5..40).contains(&builds),
            "lists are kept and rebuilt: {builds} builds in 60 moves"
        );
    }

    #[test]
    fn lists_kept_for_ten_times_too_long_lose_pairs() {
        assert!(lost(5.0, &mut 0) > 0);
    }

    /// The particles of a lattice of this spacing in order, each group of eight at a time; cells are 2 wide.
    fn groups(columns: usize, rows: usize, dx: f64) -> Vec<Vec<Vector2<f64>>> {
        let at = |n: usize| (n as f64 + 0.5) * dx;
        let place = |k: usize| Vector2::new(at(k % columns), at(k / columns));
        let points: Vec<_> = (0..columns * rows).map(place).collect();
        let mut neighbours =
            Neighbours::new(Reach { support: 3.1, skin: 0.0, spacing: 1.0 }, Domain::open(), &[]);
        neighbours.place(points.len(), &|k| points[k]);
        let mut order = Vec::new();
        neighbours.order(&mut order);
        let points: Vec<_> = order.iter().map(|&k| points[k as usize]).collect();
        points.chunks(GROUP).map(<[_]>::to_vec).collect()
    }

    /// Size and middle of a group.
    fn extent(group: &[Vector2<f64>]) -> [Vector2<f64>; 2] {
        let low = group.iter().fold(group[0], |a, p| a.inf(p));
        let high = group.iter().fold(group[0], |a, p| a.sup(p));
        [high - low, 0.5 * (low + high)]
    }

    /// A lattice of one and a half tiles: groups are four by two, each next to the previous one, and list 60
    /// particles within three spacings.
    #[test]
    fn groups_of_a_lattice_are_four_by_two_and_side_by_side() {
        let groups = groups(96, 12, 1.0);
        assert!(groups.iter().all(|group| extent(group)[0] == Vector2::new(3.0, 1.0)));
        let middles: Vec<_> = groups.iter().map(|group| extent(group)[1]).collect();
        let steps = middles.windows(2).map(|ends| (ends[1] - ends[0]).norm());
        let far: Vec<f64> = steps.filter(|step| *step > 4.0).collect();
        assert!(far.len() <= 1, "from the end of the first tile to the second one alone: {far:?}");
        let mut neighbours =
            Neighbours::new(Reach { support: 3.1, skin: 0.0, spacing: 1.0 }, Domain::open(), &[]);
        neighbours.place(groups.len() * GROUP, &|k| groups[k / GROUP][k % GROUP]);
        neighbours.build(96 * 12, 0, false);
        for (k, middle) in middles.iter().enumerate() {
            let inside = [(middle.x, 96.0), (middle.y, 12.0)];
            if inside.iter().all(|(at, end)| at.min(end - at) > 4.9) {
                let seen = neighbours.lists.blocks[k * GROUP / BLOCK].list(k % (BLOCK / GROUP));
                assert_eq!(seen.len(), 60);
            }
        }
    }

    /// Cells with four, six or nine particles: groups begin and end inside of cells.
    #[test]
    fn groups_that_begin_inside_of_a_cell_are_as_compact() {
        for group in groups(50, 14, 0.8) {
            let [size, _] = extent(&group);
            assert!(size.x < 3.0 * 0.8 + 1e-9, "{group:?}");
        }
    }

    #[test]
    fn the_order_does_not_depend_on_the_order_the_particles_came_in() {
        let mut random = random(5);
        let mut points: Vec<_> = (0..300).map(|_| point(&mut random, [2.0, 5.0])).collect();
        let sorted = |points: &[Vector2<f64>]| {
            let mut order = Vec::new();
            let mut neighbours = Neighbours::new(
                Reach { support: 0.3, skin: 0.0, spacing: 0.18 },
                Domain::open(),
                &[],
            );
            neighbours.place(points.len(), &|k| points[k]);
            neighbours.order(&mut order);
            order.iter().map(|&k| points[k as usize]).collect::<Vec<_>>()
        };
        let first = sorted(&points);
        for k in (1..points.len()).rev() {
            points.swap(k, ((random() + 0.5) * (k + 1) as f64) as usize);
        }
        assert_eq!(sorted(&points), first);
    }
}
