// SPDX-License-Identifier: MIT
// An arm whose masses are known, logged with friction and noise, and fitted again.
#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <limits>

#include "arm/fit/stated_arm.hpp"
#include "arm_support.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/log/log.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

constexpr double noise_nm = 0.5, coulomb_nm = 4.0, viscous_nm = 3.0;

// A log of the arm in `chain` at 200 Hz.
struct Recorded {
    std::vector<Trace> traces;

    Recorded(const Chain& chain, const std::vector<double>& links, const std::vector<Motion>& motions,
             unsigned seed) {
        std::mt19937_64 random(seed);
        // Twelve uniform numbers have the variance of one normal number.
        const auto normal = [&] {
            double sum = -6.0;
            for (int k = 0; k < 12; ++k) sum += 0x1p-53 * static_cast<double>(random() >> 11);
            return sum;
        };
        for (std::size_t j = 0; j < chain.size(); ++j) {
            const Motion& motion = motions[j];
            Trace trace{"log.csv",          chain.joints[j].name,  motion.sample_rate,
                        motion.time_s,      motion.velocity_deg_s, arm_torque(chain, links, motions, j),
                        motion.position_deg};
            for (std::size_t k = 0; k < trace.size(); ++k) {
                const double v = radians * motion.velocity_deg_s[k];
                trace.torque_nm[k] +=
                    coulomb_nm * std::tanh(v / (1.5 * radians)) + viscous_nm * v + noise_nm * normal();
                trace.velocity_deg_s[k] += 0.02 * normal();
            }
            traces.push_back(std::move(trace));
        }
    }

    [[nodiscard]] ArmLog view() const {
        ArmLog log;
        for (const Trace& trace : traces) log.joints.push_back(trace.view());
        log.has_torque.assign(traces.size(), true);
        return log;
    }
};

struct Six {
    Chain chain = chain_of_dh("six.csv", six_dh);
    std::vector<double> links = random_links(6, 3);
    Recorded log{chain, links, fourier_motions(6, 40.0, 200.0, 4, 60.0), 5};
};

// A fit with a window and a pull that need not be looked for.
ArmFitOptions quick() {
    ArmFitOptions options;
    options.smoothing = Seconds(0.12);
    options.pull = 0.1;
    return options;
}

double left(const std::vector<double>& predicted, const TraceView& log, std::size_t first) {
    double sum = 0.0;
    for (std::size_t k = first; k < log.size(); ++k)
        sum += (predicted[k] - log.torque_nm[k]) * (predicted[k] - log.torque_nm[k]);
    return std::sqrt(sum / static_cast<double>(log.size() - first));
}

std::vector<double> sum_of(const GivenTerm& term, const std::vector<double>& values) {
    std::vector<double> sum(term.torque_nm[0].size(), 0.0);
    for (std::size_t c = 0; c < values.size(); ++c)
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[c] * term.torque_nm[c][k];
    return sum;
}

}  // namespace

TEST_CASE("an arm fitted to a part of a log leaves noise alone on the rest", "[arm]") {
    const Six six;
    const ArmLog log = six.log.view();
    const std::size_t rows = log.joints.front().size(), first = rows * 6 / 10;
    ArmFitOptions options;
    options.use.assign(rows, false);
    std::fill_n(options.use.begin(), first, true);
    const ArmFit fit = fit_arm(six.chain, log, options);
    CHECK(fit.values_there == 36);
    CHECK(fit.values_told == 36);
    for (std::size_t j = 0; j < 6; ++j) {
        INFO("joint " << j + 1);
        CHECK(left(fitted_torque(six.chain, fit, log, j), log.joints[j], first) < 1.1 * noise_nm);
        // What the fit says of itself on rows left out is what they show.
        CHECK_THAT(fit.find(j)->error_nm, WithinRel(noise_nm, 0.15));
        CHECK_THAT(fit.find(j)->beside_nm[static_cast<std::size_t>(BesideArm::coulomb)],
                   WithinAbs(coulomb_nm, 0.8));
    }
    CHECK(arm_warnings(fit, arm_travel(six.chain, log, {"1", "2", "3", "4", "5", "6"})).empty());
}

TEST_CASE("the same log gives the same arm to the byte", "[arm]") {
    const Six six;
    const ArmFit one = fit_arm(six.chain, six.log.view(), quick()),
                 two = fit_arm(six.chain, six.log.view(), quick());
    const auto same = [](const std::vector<double>& a, const std::vector<double>& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
    };
    CHECK(same(one.values, two.values));
    for (std::size_t j = 0; j < 6; ++j) {
        CHECK(same(one.joints[j].mean, two.joints[j].mean));
        CHECK(same(one.joints[j].precision, two.joints[j].precision));
    }
}

TEST_CASE("a motion that other joints have shown is known to one that has not made it", "[arm]") {
    // Half of the log is enough for all joints together; for the second alone it is a motion never seen.
    const Six six;
    const ArmLog log = six.log.view();
    ArmFitOptions options;
    const std::size_t rows = log.joints.front().size(), first = rows / 8;
    options.use.assign(rows, false);
    std::fill_n(options.use.begin(), first, true);
    const ArmFit all = fit_arm(six.chain, log, options);
    options.joints = {1};
    const ArmFit alone = fit_arm(six.chain, log, options);
    CHECK(alone.joints.size() == 1);
    CHECK(alone.values_there < all.values_there);
    CHECK(left(fitted_torque(six.chain, all, log, 1), log.joints[1], first) <
          0.9 * left(fitted_torque(six.chain, alone, log, 1), log.joints[1], first));
}

TEST_CASE("what other joints say of an arm is a mean and a deviation of 1 in columns of its own", "[arm]") {
    const Six six;
    const ArmLog log = six.log.view();
    const ArmFit fit = fit_arm(six.chain, log, quick());
    for (const std::size_t joint : {0U, 2U}) {
        const GivenTerm term = arm_term(six.chain, fit, log, joint);
        REQUIRE(term.torque_nm.size() == term.mean.size());
        REQUIRE(term.torque_nm.size() == term.deviation.size());
        CHECK(term.deviation.front() == 1.0);
        const auto by_mean =
            arm_torque(six.chain, fit.find(joint)->mean, arm_motions(log, fit.smoothing), joint);
        const auto by_columns = sum_of(term, term.mean);
        // Smoothed over 0.12 s, which the motion's 0.5 Hz hardly feels.
        for (std::size_t k = 50; k + 50 < by_mean.size(); k += 100)
            CHECK_THAT(by_columns[k], WithinAbs(by_mean[k], 0.3));
        // The other five joints tell the third one's torque without it, friction and what only it shows
        // apart.
        if (joint == 2) CHECK(left(by_columns, log.joints[2], 0) < coulomb_nm + viscous_nm + 2.0);
    }
    // Knowledge weighs in a fit of noisier rows what it weighs here.
    const GivenTerm noisy = arm_term(six.chain, fit, log, 2, ArmKnowledge::other_joints,
                                     3.0 * fit.find(2)->smoothed_error_nm * std::sqrt(fit.weighed_rows));
    CHECK_THAT(noisy.deviation.front(), WithinRel(3.0, 1e-12));
}

TEST_CASE("an arm that only the pull knows has ten columns a link from its joint on", "[arm]") {
    const Six six;
    const ArmLog log = six.log.view();
    const ArmFit fit = fit_arm(six.chain, log, quick());
    const GivenTerm term = arm_term(six.chain, fit, log, 3, ArmKnowledge::pull);
    const auto columns = arm_columns(six.chain, arm_motions(log, fit.smoothing), 3);
    CHECK(term.name == "arm");
    REQUIRE(term.torque_nm.size() == 31);
    for (std::size_t k = 50; k < 7000; k += 50)
        CHECK_THAT(term.torque_nm[1][k], WithinAbs(columns[31][k], 0.15));
    CHECK(term.mean == std::vector<double>(term.mean.size(), 0.0));
    CHECK_THAT(term.deviation[1], WithinRel(0.5 / std::sqrt(fit.pull), 1e-12));
}

TEST_CASE("smoothing leaves parabolas as they are and takes most of a noise away", "[arm]") {
    std::vector<double> time_s, parabola, noise;
    std::mt19937_64 random(1);
    double jitter = 0.0;
    for (int k = 0; k < 2000; ++k) {
        jitter = 0x1p-53 * static_cast<double>(random() >> 11);
        const double t = 0.01 * (k + 0.5 * jitter);
        time_s.push_back(t);
        parabola.push_back(1.0 + 2.0 * t - 3.0 * t * t);
        noise.push_back(0x1p-52 * static_cast<double>(random() >> 11) - 1.0);
    }
    const auto same = smooth_along(time_s, parabola, Seconds(0.2)),
               less = smooth_along(time_s, noise, Seconds(0.2));
    double before = 0.0, after = 0.0;
    for (std::size_t k = 0; k < same.size(); ++k) {
        REQUIRE_THAT(same[k], WithinAbs(parabola[k], 1e-9));
        before += noise[k] * noise[k];
        after += less[k] * less[k];
    }
    // Twenty values a window: their variance is divided by some seven.
    CHECK(after < before / 5.0);
    CHECK(smooth_along(time_s, noise, Seconds(0.0)) == noise);
}

TEST_CASE("joints that hardly move are told, and the fit stays whole", "[arm]") {
    Chain chain = chain_of_dh("six.csv", six_dh);
    auto motions = fourier_motions(6, 20.0, 200.0, 4, 60.0);
    for (std::size_t j = 1; j < 6; ++j) {
        motions[j].position_deg.assign(motions[j].size(), 10.0);
        motions[j].velocity_deg_s.assign(motions[j].size(), 0.0);
        motions[j].acceleration_deg_s2.assign(motions[j].size(), 0.0);
    }
    const Recorded recorded(chain, random_links(6, 3), motions, 5);
    const ArmLog log = recorded.view();
    const ArmFit fit = fit_arm(chain, log, quick());
    CHECK(fit.values_told < 20);
    CHECK(left(fitted_torque(chain, fit, log, 0), log.joints[0], 0) < 1.1 * noise_nm);
    const auto warnings = arm_warnings(fit, arm_travel(chain, log, {"a", "b", "c", "d", "e", "f"}));
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings.front(), Contains("of 36 values can be determined from this log") &&
                                     Contains("'b', 'c', 'd', 'e', 'f' hardly move"));
}

TEST_CASE("a position in another unit exceeds the chain's limits", "[arm]") {
    Six six;
    for (ChainJoint& joint : six.chain.joints) joint.limits.emplace(-180.0, 180.0);
    const std::vector<std::string> names = {"1", "2", "3", "4", "5", "6"};
    CHECK(arm_travel(six.chain, six.log.view(), names).size() == 6);
    for (double& position : six.log.traces[1].position_deg) position *= 180.0 / std::numbers::pi;
    CHECK_THROWS_WITH(arm_travel(six.chain, six.log.view(), names),
                      Contains("position of '2' reaches") && Contains("--unit position=deg"));
}

TEST_CASE("a log that no arm can be fitted to is refused", "[arm][broken]") {
    Six six;
    ArmLog log = six.log.view();
    log.has_torque.assign(6, false);
    CHECK_THROWS_WITH(fit_arm(six.chain, log), Contains("no joint of six.csv has a torque"));
    log.has_torque.assign(6, true);
    log.joints[3].position_deg = {};
    CHECK_THROWS_WITH(fit_arm(six.chain, log), Contains("'j4' has 8000 rows without position"));
    log.joints.pop_back();
    CHECK_THROWS_WITH(fit_arm(six.chain, log), Contains("5 joints of a log for 6"));
    ArmFitOptions few = quick();
    few.use.assign(8000, false);
    few.use[5] = true;
    CHECK_THROWS_WITH(fit_arm(six.chain, six.log.view(), few), Contains("1 rows count"));
    six.log.traces[2].torque_nm[7] = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(fit_arm(six.chain, six.log.view()), Contains("not finite in row 8"));
    ArmFitOptions others = quick();
    others.joints = {0, 1};  // the torque that is none is not looked at
    CHECK(fit_arm(six.chain, six.log.view(), others).joints.size() == 2);
    for (Trace& trace : six.log.traces) {
        trace.torque_nm[7] = 0.0;
        trace.velocity_deg_s.assign(8000, 0.0);
        trace.position_deg.assign(8000, 1.0);
    }
    CHECK_THROWS_WITH(fit_arm(six.chain, six.log.view()), Contains("no joint moves"));
}

// An arm whose values are stated gives the torque that its columns gave with the values they were fitted to.

namespace {

const std::string three_dh = "a_m,alpha_deg,d_m,theta_deg\n0,90,0.3,0\n0.4,0,0,0\n0.3,0,0,0\n";

struct RecordedArm {
    std::vector<Trace> joints;

    RecordedArm(const Chain& chain, unsigned seed) {
        const auto motions = fourier_motions(chain.size(), 12.0, 100.0, seed, 60.0);
        const auto links = random_links(chain.size(), 5);
        for (std::size_t j = 0; j < chain.size(); ++j) {
            Trace& trace = joints.emplace_back();
            trace.sample_rate = Hertz(100.0);
            trace.time_s = motions[j].time_s;
            trace.position_deg = motions[j].position_deg;
            trace.velocity_deg_s = motions[j].velocity_deg_s;
            trace.torque_nm = arm_torque(chain, links, motions, j);
        }
    }
    [[nodiscard]] ArmLog view() const {
        ArmLog log;
        for (const Trace& joint : joints) log.joints.push_back(joint.view());
        log.has_torque.assign(joints.size(), true);
        return log;
    }
};

ArmFitOptions barely_pulled() {
    ArmFitOptions options;
    options.smoothing = Seconds(0.12);
    options.pull = 1e-3;
    return options;
}

}  // namespace

TEST_CASE("links of fitted columns give the same torque, along the log of the fit and along another",
          "[arm]") {
    const Chain chain = chain_of_dh("three.csv", three_dh);
    const RecordedArm log(chain, 3), other(chain, 8);
    const ArmFit fit = fit_arm(chain, log.view(), barely_pulled());
    for (const ArmKnowledge knowledge : {ArmKnowledge::other_joints, ArmKnowledge::pull}) {
        for (std::size_t joint = 0; joint < 3; ++joint) {
            GivenTerm term = arm_term(chain, fit, log.view(), joint, knowledge);
            std::vector<double> values = term.mean;
            for (std::size_t v = 0; v < values.size(); ++v)
                values[v] += term.deviation[v] * (0.3 * static_cast<double>(v % 5) - 0.5);
            const ArmValues stated = arm_values(chain, fit, joint, values, knowledge);
            CHECK(stated.links.size() == 30);
            for (const RecordedArm* recorded : {&log, &other}) {
                term = arm_term(chain, fit, recorded->view(), joint, knowledge);
                const auto by_columns = sum_of(term, values);
                const auto by_links = stated_torque(chain, stated, fit.smoothing, recorded->view(), joint);
                double size = 0.0, worst = 0.0;
                for (std::size_t k = 0; k < by_links.size(); ++k) {
                    size = std::max(size, std::abs(by_columns[k]));
                    worst = std::max(worst, std::abs(by_columns[k] - by_links[k]));
                }
                INFO("joint " << joint);
                CHECK(worst < 1e-9 * size);
            }
        }
    }
}

TEST_CASE("values for another joint are refused", "[arm]") {
    const Chain chain = chain_of_dh("three.csv", three_dh);
    const RecordedArm log(chain, 3);
    const ArmFit fit = fit_arm(chain, log.view(), barely_pulled());
    CHECK_THROWS_AS(arm_values(chain, fit, 1, std::vector<double>(30, 0.0)), UsageError);
}

// Arms fitted to logs of real robots and judged on rows that nothing was fitted to. The logs are not part of
// the project; run with test_arm "[real]".

namespace {

// UR10: Universal Robots, "DH parameters for calculations of kinematics and dynamics", support articles; the
// log's robot is an older one, with the lengths of ur_description's ur10.
const std::string ur10_dh =
    "theta_deg,d_m,a_m,alpha_deg\n0,0.1273,0,90\n0,0,-0.612,0\n0,0,-0.5723,0\n0,0.163941,0,90\n"
    "0,0.1157,0,-90\n0,0.0922,0,0\n";
// KUKA KR300 R2500: the data sheet's lengths as the log's authors give them; the base frame points down.
const std::string kuka_dh =
    "theta_deg,d_m,a_m,alpha_deg\n0,-0.675,0.35,90\n0,-0.189,1.15,0\n90,0.189,0.041,-90\n0,-1,0,90\n"
    "0,0,0,-90\n0,-0.24,0,180\n";

struct Robot {
    std::vector<Log> logs;
    ArmLog log;
    explicit Robot(const std::string& name) : logs(read_joints_at_once(logs_folder() + "/" + name, {})) {
        for (const Log& joint : logs) {
            log.joints.push_back(joint.trace.view());
            log.has_torque.push_back(true);
        }
    }
};

bool absent(const std::string& name) {
    if (std::filesystem::exists(logs_folder() + "/" + name)) return false;
    skipped(name + " is not in the folder of real logs");
    return true;
}

double rms(std::span<const double> a, std::span<const double> b, std::size_t first) {
    double sum = 0.0;
    for (std::size_t k = first; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(sum / static_cast<double>(a.size() - first));
}

// Fit on the first rows of one log, left on the later rows of it or all of another.
std::vector<double> left(const Chain& chain, const Robot& one, const Robot* other, bool alone) {
    ArmFitOptions options;
    const std::size_t rows = one.log.joints.front().size();
    const std::size_t first = other == nullptr ? rows * 6 / 10 : 0;
    if (other == nullptr) {
        options.use.assign(rows, false);
        std::fill_n(options.use.begin(), first, true);
    }
    const ArmLog& judge = other == nullptr ? one.log : other->log;
    std::vector<double> found;
    std::string words;
    std::optional<ArmFit> all;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        if (alone) options.joints = {j};
        if (alone || !all) all = fit_arm(chain, one.log, options);
        if (alone || j == 0)
            words += fmt::format(" [pull {:g}, {} s, {} of {}]", all->pull, all->smoothing.value(),
                                 all->values_told, all->values_there);
        found.push_back(rms(judge.joints[j].torque_nm, fitted_torque(chain, *all, judge, j), first));
        words += fmt::format(" {:.3f}", found.back());
    }
    WARN(chain.source << (alone ? " alone:" : " all:") << words);
    return found;
}

void require_below(const std::vector<double>& found, const std::vector<double>& most) {
    for (std::size_t j = 0; j < most.size(); ++j) {
        INFO("joint " << j + 1);
        CHECK(found[j] < most[j]);
    }
}

}  // namespace

TEST_CASE("real: a Panda's arm", "[.real]") {
    const std::string name = "gpl3/panda_gaz_all.csv";
    if (absent(name)) return;
    const Robot robot(name);
    const Chain chain = chain_of_mdh("panda", panda_mdh);
    require_below(left(chain, robot, nullptr, false), {0.35, 0.42, 0.30, 0.43, 0.12, 0.13, 0.055});
}

TEST_CASE("real: a UR10's arm") {
    const std::string name = "ur10_unisa_exciting_all.csv";
    if (absent(name)) return;
    const Robot robot(name);
    const Chain chain = chain_of_dh("ur10", ur10_dh);
    require_below(left(chain, robot, nullptr, false), {1.5, 3.4, 1.9, 0.5, 0.35, 1.5});
}

TEST_CASE("real: a KUKA's arm") {
    const std::string name = "kuka_kr300_trajA_all.csv";
    if (absent(name)) return;
    const Robot robot(name), other("kuka_kr300_trajB_all.csv");
    Chain chain = chain_of_dh("kuka", kuka_dh);
    chain.gravity_m_s2 = {0, 0, 9.81};
    require_below(left(chain, robot, &other, false), {1.25, 3.6, 2.2, 0.5, 0.55, 0.45});
}

TEST_CASE("real: a Panda by the directions of its axes alone", "[.axes]") {
    const std::string name = "gpl3/panda_gaz_all.csv";
    if (absent(name)) return;
    require_below(left(chain_of_axes("zyzYzYZ"), Robot(name), nullptr, true),
                  {0.4, 0.5, 0.33, 0.52, 0.13, 0.155, 0.06});
}

// Faults of the set-up of an arm whose truth is known.

namespace {

// A log with friction of each joint at 100 Hz.
struct ArmRecord {
    Chain chain = chain_of_dh("six.csv", six_dh);
    std::vector<Trace> traces;

    ArmRecord(unsigned seed, double friction_nm) {
        std::mt19937_64 random(seed);
        const auto motions = fourier_motions(6, 30.0, 100.0, seed + 4, 50.0);
        const auto links = random_links(6, seed + 3);
        for (std::size_t j = 0; j < chain.size(); ++j) {
            const Motion& motion = motions[j];
            Trace trace{"log.csv",          chain.joints[j].name,  motion.sample_rate,
                        motion.time_s,      motion.velocity_deg_s, arm_torque(chain, links, motions, j),
                        motion.position_deg};
            for (std::size_t k = 0; k < trace.size(); ++k)
                trace.torque_nm[k] += friction_nm * std::tanh(motion.velocity_deg_s[k] / 1.5) +
                                      0x1p-53 * static_cast<double>(random() >> 11) - 0.5;
            traces.push_back(std::move(trace));
        }
    }

    [[nodiscard]] std::vector<SetupFault> faults() const {
        ArmLog log;
        for (const Trace& trace : traces) log.joints.push_back(trace.view());
        log.has_torque.assign(traces.size(), true);
        ArmFitOptions options;
        options.smoothing = Seconds(0.12);
        return suspect_arm(chain, log, fit_arm(chain, log, options), options);
    }
    void reverse(std::size_t joint) {
        for (double& each : traces[joint].torque_nm) each = -each;
    }
};

}  // namespace

TEST_CASE("an arm that is right has no fault, with or without friction", "[arm]") {
    CHECK(ArmRecord(1, 0.0).faults().empty());
    CHECK(ArmRecord(2, 4.0).faults().empty());
}

TEST_CASE("gravity along another axis of the base is found, with the option that states it", "[arm]") {
    for (const Vector3& stated : {Vector3{0, 0, 9.81}, Vector3{9.81, 0, 0}}) {
        ArmRecord record(3, 2.0);
        record.chain.gravity_m_s2 = stated;
        const auto faults = record.faults();
        REQUIRE(faults.size() == 1);
        CHECK(faults.front().kind == SetupFaultKind::gravity_direction);
        CHECK(faults.front().option == "gravity=0:0:-9.81");
        CHECK(faults.front().explained_after > faults.front().explained_before);
    }
}

TEST_CASE("torques whose sign is reversed are found: of one joint, and of all by their friction", "[arm]") {
    ArmRecord record(4, 2.0);
    record.reverse(2);
    auto faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().kind == SetupFaultKind::torque_sign);
    CHECK_THAT(faults.front().statement, Catch::Contains("joint " + record.chain.joints[2].name + " has"));
    for (const std::size_t joint : {0, 1, 3, 4, 5}) record.reverse(joint);
    faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK_THAT(faults.front().statement, Catch::Contains("friction would drive the arm"));
}

TEST_CASE("a torque in mNm and exchanged joints are found", "[arm]") {
    ArmRecord record(5, 2.0);
    for (double& each : record.traces[1].torque_nm) each *= 1000.0;
    auto faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().kind == SetupFaultKind::torque_unit);
    CHECK_THAT(faults.front().statement,
               Catch::Contains("joint " + record.chain.joints[1].name + " is in mNm"));
    for (double& each : record.traces[1].torque_nm) each /= 1000.0;
    std::swap(record.traces[1], record.traces[2]);
    faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().kind == SetupFaultKind::wrong_joint);
    std::swap(record.traces[1], record.traces[2]);
    std::swap(record.traces[1].torque_nm, record.traces[2].torque_nm);
    faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().kind == SetupFaultKind::wrong_joint);
    CHECK_THAT(faults.front().statement, Catch::Contains("the torques of joints"));
}

// The delay of an arm's torques behind its motion: one for all joints, and a joint that contradicts it.

namespace {

// A log at 200 Hz of six joints whose torques have these delays, with friction and noise.
std::optional<ArmLag> lag_of(const std::array<double, 6>& delays_s, unsigned seed) {
    const Chain chain = chain_of_dh("six.csv", six_dh);
    std::mt19937_64 random(seed);
    const auto motions = fourier_motions(6, 30.0, 200.0, seed + 4, 50.0);
    const auto links = random_links(6, seed + 3);
    std::vector<std::vector<double>> torques;
    ArmLog log;
    for (std::size_t j = 0; j < 6; ++j) {
        const Motion& motion = motions[j];
        auto torque_nm = arm_torque(chain, links, motions, j);
        for (std::size_t k = 0; k < torque_nm.size(); ++k)
            torque_nm[k] += 2.0 * std::tanh(motion.velocity_deg_s[k] / 1.5);
        torques.push_back(std::move(torque_nm));
        log.joints.push_back(
            {motion.sample_rate, motion.time_s, motion.velocity_deg_s, torques[j], motion.position_deg});
    }
    log.has_torque.assign(6, true);
    std::vector<std::vector<double>> late(6);
    for (std::size_t j = 0; j < 6; ++j) {
        const AdvancedLog moved(log, -delays_s[j]);
        late[j].assign(moved.log.joints[j].torque_nm.begin(), moved.log.joints[j].torque_nm.end());
        for (double& each : late[j]) each += 0x1p-53 * static_cast<double>(random() >> 11) - 0.5;
    }
    for (std::size_t j = 0; j < 6; ++j) log.joints[j].torque_nm = late[j];
    ArmFitOptions options;
    options.smoothing = Seconds(0.08);
    return common_lag(chain, log, fit_arm(chain, log, options), options);
}

}  // namespace

TEST_CASE("the delay of all torques is one number whose interval holds it", "[arm]") {
    for (const double delay_s : {0.0, 0.0088, -0.0131}) {
        CAPTURE(delay_s);
        const auto lag = lag_of({delay_s, delay_s, delay_s, delay_s, delay_s, delay_s}, 1);
        REQUIRE(lag);
        CHECK(lag->delay_s == Approx(delay_s).margin(1e-3));
        CHECK(lag->delay_95_s.low <= delay_s);
        CHECK(lag->delay_95_s.high >= delay_s);
        CHECK(lag->is_there() == (delay_s != 0.0));
    }
}

TEST_CASE("a joint with a delay of its own contradicts that of the others", "[arm]") {
    const auto lag = lag_of({0.006, 0.006, 0.02, 0.006, 0.006, 0.006}, 2);
    REQUIRE(lag);
    CHECK(lag->delay_s == Approx(0.006).margin(1e-3));
    for (const JointLag& joint : lag->joints) CHECK(joint.contradicts == (joint.joint == 2));
    CHECK(lag->contradicted_by(2));
    CHECK(!lag->contradicted_by(1));
}
