//! Groups: of so many members, or of people who were seen together; as members who attract each other, or as one body
//! (Given-Wilson et al. 2017, section 4.2).

use crate::base::geometry::Vec2;
use crate::base::math;
use crate::compile::behaviour::attachment;
use crate::compile::context::{
    Context, Locals, Lowered,
    conducts::With,
    people::People,
    sighting::{Sighting, agree},
    symbols::Meaning,
};
use crate::compile::dimension::Dimension;
use crate::compile::people::{
    self, headed,
    intended::{Intended, parted},
    intentions, kinds, positions, recordings,
};
use crate::model::{self, AgentId, Barrier, Body, Group, Parameter, Particle, Route, Start};
use crate::syntax::ast::{Field, GroupDecl, Recorded, Value};
use std::sync::Arc;

/// Friction where two particles overlap, kg/(m s), unless the group sets its own: two couples that pass
/// through each other with an overlap of a metre lose half of their relative speed in about a second.
const PARTICLE_FRICTION: f64 = 40.0;
/// Factor of the social force between two particles, unless the group sets its own.
const PARTICLE_REPULSION: f64 = 0.5;

/// What members of a group have in common.
struct Common<'a> {
    body: Body,
    route: Route,
    attraction: f64,
    repulsion: f64,
    friction: f64,
    /// Whether the group sets the radius, the relaxation time and the speed of its body.
    own: [bool; 3],
    /// What they want, if they were recorded.
    intended: Intended<'a>,
}

impl Common<'_> {
    /// One body for some persons, who are so far from their middle and have so much room, m.
    fn particle(&self, persons: usize, (spread, room): (f64, f64)) -> Particle {
        let size = (persons as f64).sqrt();
        let [radius, tau, _] = self.own;
        Particle {
            persons: persons as u32,
            repulsion: self.repulsion,
            friction: self.friction,
            radius_factor: if radius { 1.0 } else { size },
            spread: if radius { 0.0 } else { spread },
            room: if radius { f64::INFINITY } else { room },
            tau_factor: if tau { 1.0 } else { size },
        }
    }
}

/// `group friends[2]: companion as particle { … }`, `groups crowd: adult as particle from hotel at 646.8 s`
pub(crate) fn group<'a>(context: &mut Context<'a>, decl: &'a GroupDecl, people: &mut People) {
    let count = match (&decl.count, &decl.recorded) {
        (Some(count), None) => people::counted(context, count),
        (Some(count), Some(_)) => {
            let said = "the recording determines the number of members";
            context.report(error!(E0402, count.span, "{said}"; hint: "remove the number in brackets"))
        }
        (None, Some(_)) => Ok(0),
        (None, None) => {
            let said = format!("the number of members of `{}` is missing", decl.name.name);
            context.report(error!(E0402, decl.name.span, "{said}";
                    hint: "write `group {}[2]: …`", decl.name.name))
        }
    };
    let with = attachment::with(context, &decl.name, &decl.with);
    let common = common(context, decl, people);
    let (Ok(count), Ok((common, rest, placed))) = (count, common) else {
        if let Some(recorded) = &decl.recorded {
            let _ = recordings::sighted(context, recorded, false);
            intentions::look_at(context, &parted(&decl.body).0);
        }
        people::define_empty(context, &decl.name, decl.particle.is_none() || decl.plural, with);
        return;
    };
    if let Some(recorded) = &decl.recorded {
        seen_together(context, decl, recorded, &common, with, people);
        return;
    }
    if let (Some(span), 0) = (decl.particle, count) {
        context.note(error!(E0402, span, "a particle needs at least one person"));
        people::define_empty(context, &decl.name, false, with);
        return;
    }
    let particle = decl.particle.map(|_| common.particle(count, (0.0, f64::INFINITY)));
    let bodies = if particle.is_some() { 1 } else { count };
    let body = Arc::new(common.body.clone());
    let each = |_| (body.clone(), placed.clone(), common.route.clone());
    let Ok(members) = people::enlist(context, &decl.name, bodies, particle.is_none(), people, each) else {
        people::define_empty(context, &decl.name, particle.is_none(), with);
        return;
    };
    people.written(&members, &rest, decl.name.span);
    if particle.is_some() {
        people.agents[members[0].0 as usize].particle = particle;
    } else {
        people.join(&decl.name.name, &members, common.attraction);
    }
    attachment::attach(context, with, &members);
    let particle = particle.is_some();
    context.names.scopes[0].define(&decl.name, Meaning::Agents { members: members.into(), particle });
}

/// The fields of a group: what its members have in common, the fields that are no parameters, and where they start.
fn common<'a>(
    context: &mut Context<'a>,
    decl: &'a GroupDecl,
    people: &mut People,
) -> Lowered<(Common<'a>, Vec<&'a Field>, Start)> {
    let mut kind = kinds::kind(context, &decl.kind);
    let (wants, fields) =
        if decl.recorded.is_some() { parted(&decl.body) } else { (Vec::new(), decl.body.iter().collect()) };
    let rest = kinds::parameters(context, fields, kind.as_mut().ok(), &Locals::default());
    let intended = intentions::intended(context, &wants);
    let start = match &decl.recorded {
        None => positions::start(context, &decl.name, &rest, people, true),
        Some(_) => Ok(Start::at_rest(Vec2::zeros())),
    };
    let is_onward = decl.recorded.is_some() && !rest.iter().any(|field| field.name.name == "route");
    let headed =
        if is_onward { start.map(|start| (start, Route::Onward)) } else { headed(context, &rest, start) };
    let attraction = of_group(context, &rest, "attraction", Dimension::FORCE, 0.0);
    let repulsion = of_group(context, &rest, "repulsion", Dimension::NONE, PARTICLE_REPULSION);
    let friction = of_group(context, &rest, "friction", Dimension::FRICTION, PARTICLE_FRICTION);
    let forces: &[&str] = if decl.particle.is_some() { &["repulsion", "friction"] } else { &["attraction"] };
    let places: &[&str] =
        if decl.recorded.is_some() { &["route"] } else { &["at", "velocity", "route", "direction"] };
    people::only(context, &rest, &[places, forces].concat());
    let body = kind.and_then(|kind| {
        let meaning = kind.base.meaning();
        if let (Some(at), true) = (decl.particle, kind.base != model::Kind::Sfm) {
            let error = error!(E0406, at, "{meaning} cannot move `as particle`");
            return context.report(error.hint("remove `as particle` to simulate the members"));
        }
        if kind.base == model::Kind::Stepped {
            let said = format!("{meaning} cannot be a group: no force acts on them");
            return context.report(error!(E0406, decl.kind.span, "{said}";
                    hint: "write `agents {}[…]`", decl.name.name));
        }
        kinds::body(context, &kind, &decl.kind)
    });
    let given = |name: &str| decl.body.iter().any(|field| field.name.name == name);
    let (start, route) = headed?;
    let common = Common {
        body: body?,
        route,
        attraction: attraction?,
        repulsion: repulsion?,
        friction: friction?,
        own: ["radius", "tau", "speed"].map(given),
        intended: intended?,
    };
    Ok((common, rest, start))
}

/// A number that a group has.
fn of_group(
    context: &mut Context<'_>,
    rest: &[&Field],
    name: &str,
    dimension: Dimension,
    unset: f64,
) -> Lowered<f64> {
    let Some(field) = rest.iter().find(|field| field.name.name == name) else { return Ok(unset) };
    let Value::Plain(expr) = &field.value else {
        let place = field.value.span();
        return context.report(error!(E0305, place, "expected a number"));
    };
    let number = context.number_of(expr, dimension, &Locals::default())?;
    if number.value < 0.0 {
        let said = format!("`{name}` cannot be negative");
        return context.report(error!(E0405, expr.span, "{said}"));
    }
    Ok(number.value)
}

/// Groups of people who were seen: all that are chosen as one group, or one for each group that is found.
fn seen_together<'a>(
    context: &mut Context<'a>,
    decl: &'a GroupDecl,
    recorded: &'a Recorded,
    common: &Common<'_>,
    with: With<'a>,
    people: &mut People,
) {
    let Ok(chosen) = recordings::sighted(context, recorded, false) else {
        people::define_empty(context, &decl.name, decl.plural || decl.particle.is_none(), with);
        return;
    };
    let mut placed = recordings::onto_rims(context, recorded, chosen.people, &common.body[Parameter::Radius]);
    if !decl.plural {
        // Whoever is declared as one group is one, whatever is inferred.
        let ids: Vec<u32> = placed.iter().map(|one| one.id).collect();
        agree(&mut placed, &[ids]);
    }
    let parties: Vec<Vec<Sighting>> = if decl.plural {
        let at = |one: &Sighting| placed.iter().find(|other| other.id == one.id).copied().unwrap_or(*one);
        chosen.parties.iter().map(|party| party.iter().map(at).collect()).collect()
    } else {
        vec![placed]
    };
    let drawn = decl.particle.is_none() && common.intended.is_drawn();
    if !decl.plural && decl.particle.is_some() && parties[0].is_empty() {
        people::unseen(context, &decl.name, common.body.clone(), with, people);
        return;
    }
    let bodies: Vec<(Sighting, Option<Particle>)> = match decl.particle {
        Some(_) => {
            // Between people on both sides of a lamp post is the lamp post.
            let middles = parties.iter().map(|party| together(party)).collect();
            let radius = &common.body[Parameter::Radius];
            let middles = recordings::onto_rims(context, recorded, middles, radius);
            let body = |(party, middle): (&Vec<Sighting>, Sighting)| {
                (middle, Some(as_one(party, &middle, common, &context.scene.barriers)))
            };
            parties.iter().zip(middles).map(body).collect()
        }
        None => parties.iter().flatten().map(|one| (*one, None)).collect(),
    };
    let is_set = decl.plural || decl.particle.is_none();
    let own_speed = common.own[2] && !common.intended.is_of_speed();
    let each: Lowered<Vec<_>> = bodies
        .iter()
        .map(|(seen, _)| {
            people::walker(context, (&common.body, own_speed), seen, &common.route, &common.intended)
        })
        .collect();
    let members = each.and_then(|each| {
        people::enlist(context, &decl.name, bodies.len(), is_set, people, |k| each[k].clone())
    });
    let Ok(members) = members else {
        people::define_empty(context, &decl.name, is_set, with);
        return;
    };
    people.written(&members, &[], recorded.span);
    for (k, (member, (_, particle))) in members.iter().zip(&bodies).enumerate() {
        let agent = &mut people.agents[member.0 as usize];
        agent.particle = *particle;
        if particle.is_some() {
            agent.start.seen = parties[k].iter().map(|one| one.id).collect();
        }
    }
    if decl.particle.is_none() {
        let mut rest = members.as_slice();
        for (k, party) in parties.iter().enumerate() {
            let (own, others) = rest.split_at(party.len());
            let name = &decl.name.name;
            let name = if decl.plural { format!("{name}[{}]", k + 1) } else { name.clone() };
            people.join(&name, own, common.attraction);
            if drawn && let Some(first) = own.first() {
                let entity = people.agents[first.0 as usize].entity;
                for one in own {
                    people.agents[one.0 as usize].start.wants_as = Some(entity);
                }
            }
            rest = others;
        }
    }
    attachment::attach(context, with, &members);
    context.names.scopes[0]
        .define(&decl.name, Meaning::Agents { members: members.into(), particle: !is_set });
}

impl People {
    /// Makes agents the members of a group.
    fn join(&mut self, name: &str, members: &[AgentId], attraction: f64) {
        let index = self.groups.len() as u32;
        for member in members {
            self.agents[member.0 as usize].group = Some(index);
        }
        self.groups.push(Group { name: name.to_owned(), members: members.to_vec(), attraction });
    }
}

/// People who are seen together as one: at their mean, with their mean velocity.
fn together(party: &[Sighting]) -> Sighting {
    let count = party.len() as f64;
    let mean = |of: fn(&Sighting) -> Vec2| party.iter().map(of).sum::<Vec2>() / count;
    Sighting {
        id: party[0].id,
        position: mean(|one| one.position),
        velocity: mean(|one| one.velocity),
        driving: mean(|one| one.driving),
        shared: mean(|one| one.driving),
        density: party.iter().map(|one| one.density).sum::<f64>() / count,
    }
}

/// Their body around a place: as wide as they stand and barriers let them.
fn as_one(party: &[Sighting], middle: &Sighting, common: &Common<'_>, barriers: &[Barrier]) -> Particle {
    let square = party.iter().map(|one| (one.position - middle.position).norm_squared()).sum::<f64>();
    let distances = barriers.iter().map(|barrier| barrier.obstacle.distance(middle.position));
    let room = distances.fold(f64::INFINITY, math::at_most);
    common.particle(party.len(), ((square / party.len() as f64).sqrt(), room))
}
