"""Trials as arrays, and recordings from DataFrames."""

import math

import numpy
import pytest
import smc
from conftest import SMALL


def test_arrays_are_the_rows_of_the_program(small, tmp_path, program):
    trial = small.trial(3, seed=5)
    assert trial.times.shape == (121,) and trial.times[-1] == 6.0
    assert trial.positions.shape == trial.velocities.shape == (121, 3, 2)
    assert trial.present.dtype == bool and trial.present.all() and trial.radii.min() > 0.2
    assert trial.names == ["user", "crowd[1]", "crowd[2]"] and trial.agent("crowd[2]") == 2 and trial.ended is None
    (tmp_path / "a.scn").write_text(SMALL)
    said = program("simulate", "a.scn", "--seed", "5", "--trial", "3", cwd=tmp_path).stdout.splitlines()
    heads = said[0].split(",")
    for line in said[1:]:
        row = dict(zip(heads, line.split(",")))
        state, agent = round(float(row["time"]) / 0.05), trial.agent(row["agent"])
        assert [float(row["x"]), float(row["y"])] == list(trial.positions[state, agent])
        assert [float(row["vx"]), float(row["vy"])] == list(trial.velocities[state, agent])
    with pytest.raises(KeyError, match="there is no agent `nobody`"):
        trial.agent("nobody")


def test_trials_in_parallel_are_the_single_ones(small):
    all_of_them = small.trials(range(6), seed=2)
    for index, trial in enumerate(all_of_them):
        assert trial.index == index and numpy.array_equal(trial.positions, small.trial(index, seed=2).positions)
    assert not numpy.array_equal(all_of_them[0].positions, all_of_them[1].positions)


def test_who_is_not_there_is_nan():
    model = smc.Model.parse(
        "horizon = 10 s\nstep = 0.1 s\nkind adult: sfm preset helbing2000\n"
        "source doors: adult { at = (0, 0); every = 3 s; limit = 4; route = (4, 0) }\n"
    )
    trial = model.trial()
    assert not trial.present[0].any() and trial.present.any()
    assert numpy.isnan(trial.positions[~trial.present]).all() and numpy.isfinite(trial.positions[trial.present]).all()


def test_processes_have_variables():
    model = smc.Model.parse("horizon = 5 steps\nprocess p { var n: 0 .. 9 = 0; when n < 8 -> n = n + 2 }\n")
    assert list(model.trial().variables["p.n"][:4]) == [0, 2, 4, 6]


def test_trials_go_to_pandas_and_pedpy(small):
    pandas = pytest.importorskip("pandas")
    trial = small.trial(1)
    frame = trial.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == 121 * 3
    one = frame[frame["name"] == "crowd[1]"]
    assert numpy.array_equal(one[["x", "y"]], trial.positions[:, 1])
    pedpy = pytest.importorskip("pedpy")
    data = trial.to_pedpy()
    assert data.frame_rate == pytest.approx(20) and data.number_pedestrians == 3
    speed = pedpy.compute_individual_speed(traj_data=data, frame_step=1)
    assert speed["speed"].max() < 5


RECORDED = """
horizon = 4 s
step = 0.1 s
tracks hall = csv "hall.csv"
kind adult: sfm preset smc2
agents people: adult from hall at 1 s
"""


def recording():
    pandas = pytest.importorskip("pandas")
    rows = [{"id": k, "t": t / 10, "x": k + 0.13 * t, "y": 2.0 * k} for k in range(3) for t in range(40)]
    return pandas.DataFrame(rows)


def test_a_dataframe_is_a_recording(tmp_path):
    frame = recording()
    base = frame.rename(columns={"t": "time"})
    model = smc.Model.parse(RECORDED, files={"hall.csv": base.to_csv(index=False).encode()})
    same = model.with_tracks("hall", frame)
    assert numpy.array_equal(smc.Model.parse(RECORDED, tracks={"hall": frame}).trial(4).positions, same.trial(4).positions)
    assert numpy.array_equal(model.trial(4).positions, same.trial(4).positions)
    moved = model.with_tracks("hall", frame.assign(y=frame["y"] + 1))
    assert numpy.allclose(moved.trial(4).positions[0, :, 1] - model.trial(4).positions[0, :, 1], 1)


def test_wrong_dataframes_are_refused_with_the_row():
    frame = recording()
    model = smc.Model.parse(RECORDED, files={"hall.csv": frame.rename(columns={"t": "time"}).to_csv(index=False).encode()})
    with pytest.raises(ValueError, match="no column `y`; its columns are id, t, x"):
        model.with_tracks("hall", frame.drop(columns="y"))
    for value in (math.nan, math.inf):
        wrong = frame.copy()
        wrong.loc[7, "x"] = value
        with pytest.raises(ValueError, match="row 7: `x` is"):
            model.with_tracks("hall", wrong)
    with pytest.raises(ValueError, match="neither a column `t`"):
        model.with_tracks("hall", frame.drop(columns="t"))
    with pytest.raises(ValueError, match="no recording `yard`"):
        model.with_tracks("yard", frame)
    with pytest.raises(TypeError):
        model.with_tracks("hall", [1, 2])
    with pytest.raises(smc.Diagnostics, match="runs backwards"):
        model.with_tracks("hall", frame.sample(frac=1, random_state=1))


def test_wrong_types_are_exceptions(small):
    with pytest.raises((TypeError, OverflowError)):
        small.trial(-1)
    with pytest.raises(TypeError):
        small.trial("first")
    with pytest.raises(ValueError):
        small.trials([0, 1], threads=0)
    with pytest.raises(ValueError, match="numbered from 0"):
        small.trial(1 << 48)
    for wrong in ({"timeout": -1}, {"timeout": math.nan}, {"max_trials": 0}, {"threads": 0}):
        with pytest.raises(ValueError, match="must be at least"):
            small.check(text="estimate P(F<=1 s contact(user))", **wrong)
    with pytest.raises((TypeError, OverflowError)):
        small.check(text="estimate P(F<=1 s contact(user))", seed=-3)
    with pytest.raises(smc.Diagnostics):
        smc.Model.parse("")


LEVELS = """
horizon = 20 s
step = 0.05 s
scene {
  level ground { region hall: rect (0, 0) .. (9, 9); line foot: (9, 2) -- (9, 4) }
  level first { height = 3 m; region hall: rect (0, 0) .. (9, 9); line head: (0, 4) -- (0, 2) }
  stairs s: ground.foot -- first.head { width = 2 m; run = 5 m }
}
kind adult: sfm preset helbing2000
agent user: adult { at = ground (6, 3); route = first (6, 3) }
"""


def test_levels_are_an_array_and_positions_are_theirs(tmp_path, program):
    model = smc.Model.parse(LEVELS)
    trial = model.trial()
    assert trial.level_names == ["ground", "first", "s"] and trial.levels.dtype == numpy.int32
    assert [int(level) for level in dict.fromkeys(trial.levels[:, 0])] == [0, 2, 1]
    (tmp_path / "a.scn").write_text(LEVELS)
    rows = [line.split(",") for line in program("simulate", "a.scn", cwd=tmp_path).stdout.splitlines()]
    place = {name: k for k, name in enumerate(rows[0])}
    for row, level, at in zip(rows[1:], trial.levels[:, 0], trial.positions[:, 0]):
        assert (row[place["level"]], float(row[place["x"]]), float(row[place["y"]])) == (trial.level_names[level], *at)
    pytest.importorskip("pandas")
    assert list(dict.fromkeys(trial.to_pandas()["level"])) == ["ground", "s", "first"]


def test_words_that_this_program_does_not_know_are_errors_with_a_place():
    with pytest.raises(smc.Diagnostics) as caught:
        smc.Model.parse("horizon = 5 s\nstep = 0.05 s\nescalators = 3\n")
    assert caught.value.errors[0].line == 3 and caught.value.hint
