#include "simulate/render/motion/grain_motion.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "simulate/md/md_simulation.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::simulate {
namespace {

const double kUnit = std::sqrt(1e-3 / 9.80665);  // seconds of sqrt(a/g), a = 1 mm

TrajectoryInfo md_info() {
    TrajectoryInfo info;
    info.origin = Origin::md;
    info.time_unit = TimeUnit::sqrt_a_over_g;
    return info;
}

Vec3 fly(Vec3 from, Vec3 v, double t) {
    return from + v * t - Vec3{0, 0, 0.5 * t * t};
}

/// One grain that is at `from`, flies with `v`, and from `hit` on with `w`.
struct Path {
    Vec3 from, v, w;
    double hit = 0;
    Vec3 at(double t) const {
        if (t <= hit) return fly(from, v, t);
        return fly(fly(from, v, hit), w, t - hit);
    }
    Vec3 velocity(double t) const { return t <= hit ? v - Vec3{0, 0, t} : w - Vec3{0, 0, t - hit}; }
};

Snapshot snapshot_of(const std::vector<Path>& paths, double time, const Box& box) {
    Snapshot s;
    s.time = time;
    s.box = box;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const Vec3 p = paths[i].at(time);
        s.position.push_back(box.wrap({p.x, p.y}));
        s.z.push_back(p.z);
        s.velocity.push_back(paths[i].velocity(time));
        s.id.push_back(static_cast<std::int64_t>(i));
    }
    return s;
}

std::vector<Path> paths_with_one_collision(double period) {
    RandomStream random(3, "collisions");
    const auto any = [&] {
        return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    };
    std::vector<Path> paths;
    for (int i = 0; i < 200; ++i) {
        paths.push_back({{random.uniform(0, 8), random.uniform(0, 8), 0.9},
                         any(),
                         any(),
                         random.uniform(0.01, 0.99) * period});
    }
    return paths;
}

GrainMotion motion_of(const std::vector<Snapshot>& all, std::size_t now) {
    return grain_motion({all, now}, md_info(), 1.94, kUnit, 1);
}

double distance_in(const Box& box, Vec3 a, Vec3 b) {
    const Vec2 d = box.minimum_image({a.x - b.x, a.y - b.y});
    return std::hypot(d.x, d.y, a.z - b.z);
}

TEST(GrainMotion, FollowsOneCollisionBetweenTwoSnapshotsExactly) {
    const Box box{{0, 0}, {8, 8}, {Boundary::periodic, Boundary::periodic}, 1.94};
    const double period = 0.13;
    const std::vector<Path> paths = paths_with_one_collision(period);
    const std::vector<Snapshot> all{snapshot_of(paths, 0, box), snapshot_of(paths, period, box)};
    for (const std::size_t now : {0U, 1U}) {
        const GrainMotion motion = motion_of(all, now);
        EXPECT_EQ(motion.flights.turned + motion.flights.free, 200);
        EXPECT_GT(motion.flights.turned, 190) << "some hardly change their velocity";
        for (std::size_t i = 0; i < paths.size(); ++i) {
            for (double t = 0; t <= period; t += period / 16) {
                const Vec3 p = motion.at(i, (t - all[now].time) * kUnit);
                ASSERT_LT(distance_in(box, p, paths[i].at(t)), 2e-4) << i << ' ' << t;
            }
        }
    }
}

TEST(GrainMotion, BetweenCollisionsIsTheParabola) {
    const Box box{{0, 0}, {8, 8}, {}, 1.94};
    std::vector<Path> paths = paths_with_one_collision(1);
    for (Path& p : paths) p.hit = 100;
    const std::vector<Snapshot> all{snapshot_of(paths, -0.1, box), snapshot_of(paths, 0, box),
                                    snapshot_of(paths, 0.13, box)};
    const GrainMotion motion = motion_of(all, 1);
    EXPECT_EQ(motion.flights.free, 400);
    EXPECT_EQ(motion.flights.turned + motion.flights.several, 0);
    const GrainMotion alone = motion_of({all[1]}, 0);
    for (const double t : {-0.08, -0.01, 0.0, 0.05, 0.12, 0.2}) {
        EXPECT_LT(norm(motion.at(7, t * kUnit) - paths[7].at(t)), 1e-12) << t;
        EXPECT_LT(norm(alone.at(7, t * kUnit) - paths[7].at(t)), 1e-12) << t;
    }
}

TEST(GrainMotion, SeveralCollisionsAreCountedAndTheEndsAreRight) {
    const Box box{{0, 0}, {8, 8}, {}, 1.94};
    // Up to 0.05 one path, from 0.10 on another one: what happened between is not known.
    const std::vector<Path> first{{{2, 2, 0.9}, {1, 0, 0}, {}, 100}};
    const std::vector<Path> last{{{2.3, 2.2, 0.8}, {-1, 1, 0.5}, {}, 100}};
    const std::vector<Snapshot> all{snapshot_of(first, 0, box), snapshot_of(last, 0.15, box)};
    const GrainMotion motion = motion_of(all, 0);
    EXPECT_EQ(motion.flights.several, 1);
    EXPECT_LT(norm(motion.at(0, 0.05 * kUnit) - first[0].at(0.05)), 1e-12);
    EXPECT_LT(norm(motion.at(0, 0.10 * kUnit) - last[0].at(0.10)), 1e-12);
}

TEST(GrainMotion, GrainsThatAreNotInTheNextSnapshotFlyOn) {
    const Box box{{0, 0}, {8, 8}, {}, 1.94};
    std::vector<Path> paths = paths_with_one_collision(1);
    for (Path& p : paths) p.hit = 100;
    Snapshot next = snapshot_of(paths, 0.13, box);
    next.position.erase(next.position.begin());
    next.z.erase(next.z.begin());
    next.velocity.erase(next.velocity.begin());
    next.id.erase(next.id.begin());
    const std::vector<Snapshot> all{snapshot_of(paths, 0, box), next};
    for (const std::size_t i : {0U, 1U, 199U}) {
        EXPECT_LT(norm(motion_of(all, 0).at(i, 0.1 * kUnit) - paths[i].at(0.1)), 1e-12) << i;
    }
}

TEST(GrainMotion, WithoutVelocitiesFollowsChordsThroughTheSnapshots) {
    const Box box{{0, 0}, {8, 8}, {Boundary::periodic, Boundary::periodic}, 1.94};
    std::vector<Snapshot> all(3);
    const std::vector<Vec2> corners{{7.8, 1}, {0.2, 1}, {0.2, 1.5}};
    for (std::size_t k = 0; k < 3; ++k) {
        all[k].time = 0.1 * static_cast<double>(k);
        all[k].box = box;
        all[k].position = {corners[k]};
        all[k].id = {5};
    }
    const GrainMotion motion = motion_of(all, 1);
    EXPECT_NEAR(motion.at(0, -0.05 * kUnit).x, 0.0, 1e-12) << "over the boundary";
    EXPECT_NEAR(motion.at(0, -0.05 * kUnit).y, 1.0, 1e-12);
    EXPECT_NEAR(motion.at(0, 0.05 * kUnit).x, 0.2, 1e-12);
    EXPECT_NEAR(motion.at(0, 0.05 * kUnit).y, 1.25, 1e-12);
}

/// All snapshots of a run.
class Kept : public SnapshotSink {
 public:
    void write(const Snapshot& snapshot) override { all.push_back(snapshot); }
    std::vector<Snapshot> all;
};

/// How often positions halfway between two snapshots are wrong.
struct Agreement {
    FlightTally flights;
    double wrong = 0;        ///< share of the positions
    double wrong_alone = 0;  ///< with the flights of the first snapshot alone
};

Agreement agreement_of(const std::vector<Snapshot>& all, std::size_t apart) {
    Agreement agreement;
    double count = 0;
    for (std::size_t k = 0; k + apart < all.size(); k += apart) {
        const std::vector<Snapshot> ends{all[k], all[k + apart]};
        const GrainMotion motion = motion_of(ends, 0);
        const GrainMotion alone = motion_of({ends[0]}, 0);
        agreement.flights.add(motion.flights);
        const Snapshot& between = all[k + apart / 2];
        const double t = (between.time - ends[0].time) * kUnit;
        for (std::size_t i = 0; i < between.size(); ++i) {
            const Vec3 p{between.position[i].x, between.position[i].y, between.z[i]};
            agreement.wrong += distance_in(between.box, motion.at(i, t), p) > 3e-4;
            agreement.wrong_alone += distance_in(between.box, alone.at(i, t), p) > 3e-4;
            ++count;
        }
    }
    agreement.wrong /= count;
    agreement.wrong_alone /= count;
    return agreement;
}

// What a run of molecular dynamics did between two snapshots.
TEST(GrainMotion, AgreesWithMolecularDynamicsBetweenTheSnapshots) {
    MdOptions md;
    md.cell.grains = 900;
    md.cell.length_x = md.cell.length_y = 30;
    md.run.periods = 5.6;
    md.run.discard = 5;
    md.run.snapshot_every = 0.01;
    RunPlan plan;
    MdSimulation run(md, make_initial_state(md, 1), 1, plan);
    Kept kept;
    while (!run.is_done()) run.run_window(kept);
    ASSERT_GT(kept.all.size(), 50U);
    for (const std::size_t apart : {2U, 10U}) {  // hundredths of a period
        const Agreement a = agreement_of(kept.all, apart);
        const auto all = static_cast<double>(a.flights.free + a.flights.turned + a.flights.several);
        const double unknown = static_cast<double>(a.flights.several) / all;
        const std::string name = "hundredths" + std::to_string(apart);
        RecordProperty(name + "_free", std::to_string(static_cast<double>(a.flights.free) / all));
        RecordProperty(name + "_several", std::to_string(unknown));
        RecordProperty(name + "_wrong", std::to_string(a.wrong));
        RecordProperty(name + "_wrong_alone", std::to_string(a.wrong_alone));
        EXPECT_LE(a.wrong, unknown + 0.002) << apart;
        EXPECT_LT(a.wrong, (apart == 2 ? 0.4 : 0.8) * a.wrong_alone) << apart;
    }
}

}  // namespace
}  // namespace grainfield::simulate
