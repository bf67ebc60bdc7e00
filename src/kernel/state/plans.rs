//! The plans that agents follow, as part of the state of a batch of trials.

use crate::base::geometry::{Segment, Vec2};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::layout::Slot;
use crate::kernel::plan::{Memory, Occasion, Piece, Plan};

/// The plans of a batch; empty while no agent has a driver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plans {
    held: Vec<[Held; LANES]>,
    pub(in crate::kernel) courses: Vec<Course>,
}

/// The plan of one agent of one trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::kernel) struct Held {
    pub(in crate::kernel) plan: Plan,
    /// Number of the next point of a way.
    pub(in crate::kernel) point: usize,
    /// The piece of a barrier that hid the point after it last; it is looked at first.
    pub(in crate::kernel) blocker: Option<u32>,
    /// The last line to a point that was found free, m, and how near a barrier is to it, m. Somebody off this line by less has the
    /// point in sight, without another test.
    pub(in crate::kernel) free: Option<(Segment, f64)>,
    /// What the driver remembers.
    pub(in crate::kernel) memory: Memory,
    /// Why the driver is to be asked.
    pub(in crate::kernel) occasion: Occasion,
    /// How often the driver has been asked.
    pub(in crate::kernel) asked: u32,
    /// The class of paths that the agent is advised to take.
    pub(in crate::kernel) path: Option<u32>,
    /// How often in a row it was seen standing while its plan moved; on a way to one of several exits, how many looks ago it was
    /// chosen.
    pub(in crate::kernel) stuck: u32,
}

/// What the vector code needs of the plans of the slots of a block.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::kernel) struct Course {
    /// Slots on a way of points.
    pub(in crate::kernel) way: Mask,
    /// Slots that are driven along a trajectory.
    pub(in crate::kernel) driven: Mask,
    /// Slots that are moved along a trajectory.
    pub(in crate::kernel) stepped: Mask,
    /// Slots that go straight to their goal as long as it is in sight.
    pub(in crate::kernel) watched: Mask,
    /// Slots to whose goal no way leads.
    pub(in crate::kernel) stranded: Mask,
    /// Slots that stand.
    pub(in crate::kernel) stands: Mask,
    /// Slots whose driver is to be asked.
    pub(in crate::kernel) asks: Mask,
    /// Slots whose plan or point is new since the last step.
    pub(in crate::kernel) fresh: Mask,
    /// Slots that lag so far behind that the time of their plan stands still.
    pub(in crate::kernel) late: Mask,
    /// Time of the plan, s.
    pub(in crate::kernel) time: Lanes,
    /// When the present piece of the trajectory begins, s.
    pub(in crate::kernel) from: Lanes,
    /// When it ends, s.
    pub(in crate::kernel) until: Lanes,
    /// Its coefficients.
    pub(in crate::kernel) x: [Lanes; 4],
    pub(in crate::kernel) y: [Lanes; 4],
    /// As in `Limits`.
    pub(in crate::kernel) correction: Lanes,
    pub(in crate::kernel) lag: Lanes,
    pub(in crate::kernel) leave: Lanes,
    /// Speed of the agent's own, m/s: what a behaviour sets changes the rate of a plan by its share.
    pub(in crate::kernel) own_speed: Lanes,
    /// The next point of a way, or where a step ends that the agent makes by itself, m.
    pub(in crate::kernel) goal_x: Lanes,
    pub(in crate::kernel) goal_y: Lanes,
    /// Where the way to that point began, m.
    pub(in crate::kernel) start_x: Lanes,
    pub(in crate::kernel) start_y: Lanes,
    /// Tick from which the driver may be asked again, or the point be looked for.
    pub(in crate::kernel) next_ask: Lanes,
}

impl Course {
    /// Slots that the route does not steer.
    pub(in crate::kernel) fn led(&self) -> Mask {
        self.way | self.driven | self.stepped | self.stands
    }

    /// Lets a lane stand at a place by itself: no force moves it.
    pub(in crate::kernel) fn rest(&mut self, lane: usize, at: Vec2) {
        self.stepped |= Mask::lane(lane);
        let span = (0.0, f64::INFINITY);
        self.set_piece(lane, &Piece { span, x: [at.x, 0.0, 0.0, 0.0], y: [at.y, 0.0, 0.0, 0.0] });
    }

    /// Puts a piece of a trajectory into a lane.
    pub(in crate::kernel) fn set_piece(&mut self, lane: usize, piece: &Piece) {
        (self.from.0[lane], self.until.0[lane]) = piece.span;
        for k in 0..4 {
            (self.x[k].0[lane], self.y[k].0[lane]) = (piece.x[k], piece.y[k]);
        }
    }

    /// Sets the point that a lane heads for, and where it begins to.
    pub(in crate::kernel) fn set_goal(&mut self, lane: usize, goal: Vec2, start: Vec2) {
        (self.goal_x.0[lane], self.goal_y.0[lane]) = (goal.x, goal.y);
        (self.start_x.0[lane], self.start_y.0[lane]) = (start.x, start.y);
    }
}

impl Plans {
    /// Whether no agent has a driver.
    #[inline(always)]
    pub(in crate::kernel) fn is_empty(&self) -> bool {
        self.courses.is_empty()
    }

    /// The slots of a block that the route does not steer.
    #[inline(always)]
    pub(in crate::kernel) fn led(&self, block: usize) -> Mask {
        self.courses.get(block).map_or(Mask::NONE, Course::led)
    }

    /// The slots of a block on a way of points.
    #[inline(always)]
    pub(in crate::kernel) fn on_way(&self, block: usize) -> Mask {
        self.courses.get(block).map_or(Mask::NONE, |course| course.way)
    }

    /// Whether the agent in a slot moves by itself, whatever forces act on it.
    pub(in crate::kernel) fn is_stepped(&self, slot: Slot) -> bool {
        self.courses.get(slot.block).is_some_and(|course| course.stepped.has(slot.lane))
    }

    /// The slots of a block that are making a step.
    #[inline(always)]
    pub(in crate::kernel) fn stepping(&self, block: usize) -> Mask {
        self.courses.get(block).map_or(Mask::NONE, |course| course.stepped & !course.stands)
    }

    /// Whether the agent in a slot is making a step.
    pub fn is_stepping(&self, slot: Slot) -> bool {
        self.courses.get(slot.block).is_some_and(|course| (course.stepped & !course.stands).has(slot.lane))
    }

    /// The plan of the agent in a slot; `None` without drivers.
    pub fn plan(&self, slot: Slot) -> Option<&Plan> {
        self.held.get(slot.block).map(|block| &block[slot.lane].plan)
    }

    /// What the driver of a slot remembers; `None` without drivers.
    pub fn memory(&self, slot: Slot) -> Option<&Memory> {
        self.held.get(slot.block).map(|block| &block[slot.lane].memory)
    }

    /// Whether the agent in a slot goes along a trajectory.
    pub(in crate::kernel) fn has_trajectory(&self, slot: Slot) -> bool {
        self.courses.get(slot.block).is_some_and(|course| (course.driven | course.stepped).has(slot.lane))
    }

    pub(in crate::kernel) fn held(&self, slot: Slot) -> &Held {
        &self.held[slot.block][slot.lane]
    }

    pub(in crate::kernel) fn held_mut(&mut self, slot: Slot) -> &mut Held {
        &mut self.held[slot.block][slot.lane]
    }

    /// Makes room for the plans of so many blocks.
    pub(in crate::kernel) fn reserve(&mut self, blocks: usize) {
        self.held.resize_with(blocks, Default::default);
        self.courses.resize_with(blocks, Course::default);
    }

    /// Takes the plan of a slot away.
    pub(in crate::kernel) fn clear(&mut self, slot: Slot) {
        if let Some(course) = self.courses.get_mut(slot.block) {
            let Course { way, driven, stepped, watched, stranded, stands, asks, fresh, late, .. } = course;
            for mask in [way, driven, stepped, watched, stranded, stands, asks, fresh, late] {
                *mask &= !Mask::lane(slot.lane);
            }
            *self.held_mut(slot) = Held::default();
        }
    }

    /// Ends the plan of a slot: the agent heads straight for its goal.
    pub(in crate::kernel) fn end(&mut self, slot: Slot) {
        let Course { way, driven, stepped, watched, stranded, stands, late, .. } =
            &mut self.courses[slot.block];
        for mask in [way, driven, stepped, watched, stranded, stands, late] {
            *mask &= !Mask::lane(slot.lane);
        }
        self.held_mut(slot).plan = Plan::Straight;
    }

    /// A slot goes straight to its goal as long as that is in sight.
    pub(in crate::kernel) fn watch(&mut self, slot: Slot) {
        self.courses[slot.block].watched |= Mask::lane(slot.lane);
    }

    /// Whether the agent in a slot has no way to its goal.
    pub fn is_stranded(&self, slot: Slot) -> bool {
        self.courses.get(slot.block).is_some_and(|course| course.stranded.has(slot.lane))
    }

    /// The driver of a slot is to be asked; of several occasions the first counts, or the end of a step.
    pub(in crate::kernel) fn ask(&mut self, slot: Slot, occasion: Occasion) {
        let is_step = occasion == Occasion::Ended && matches!(self.held(slot).plan, Plan::Step(_));
        let course = &mut self.courses[slot.block];
        if is_step || !course.asks.has(slot.lane) {
            course.asks |= Mask::lane(slot.lane);
            self.held_mut(slot).occasion = occasion;
        }
    }
}
