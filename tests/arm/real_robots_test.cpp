// SPDX-License-Identifier: MIT
// Arms fitted to logs of real robots and judged on rows that nothing was fitted to. The logs are not part of
// the project; run with test_arm "[real]".
#include <fmt/format.h>

#include <filesystem>

#include "arm_support.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/log/log.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;

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
