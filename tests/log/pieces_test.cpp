// SPDX-License-Identifier: MIT
// Logs that are too long to be held: what is kept of them, and what is still said of all of them.
#include <cmath>
#include <fstream>

#include "log_support.hpp"
#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {

struct Course {
    std::size_t rows = 8000, gap_before = 0;
    double turn_deg = 0.0;  ///< where the position starts again; 0: it goes on
    double sign = 1.0;
};

// A joint at 90 deg/s and slowly more; 1 kHz.
void write_log(const std::string& path, const Course& course) {
    std::ofstream log(path);
    log << "time_s,velocity_deg_s,torque_nm,position_deg\n";
    for (std::size_t i = 0; i < course.rows; ++i) {
        const double t = 0.001 * static_cast<double>(i);
        const double gap = course.gap_before > 0 && i >= course.gap_before ? 5.0 : 0.0;
        double position = 90.0 * t + 0.5 * t * t;
        if (course.turn_deg > 0.0) position -= course.turn_deg * std::floor(position / course.turn_deg);
        log << shortest(t + gap) << ',' << shortest(90.0 + t) << ',' << shortest(std::sin(100.0 * t)) << ','
            << shortest(course.sign * position) << '\n';
    }
}

void check_same(const Log& part, const Log& all) {
    CHECK(part.recording.rows() == all.recording.rows());
    CHECK(part.recording.clock.mean_rate == all.recording.clock.mean_rate);
    CHECK(part.recording.clock.gap_count == all.recording.clock.gap_count);
    CHECK(part.recording.angle.verdict == all.recording.angle.verdict);
    CHECK(part.trace.sample_rate == all.trace.sample_rate);
    CHECK(part.trace.source == all.trace.source);
    CHECK(part.position_range_deg == all.position_range_deg);
    REQUIRE(part.clock_factor.has_value() == all.clock_factor.has_value());
    if (all.clock_factor) CHECK(*part.clock_factor == Approx(*all.clock_factor).epsilon(1e-12));
    CHECK(part.layout.warnings.size() == all.layout.warnings.size());
    CHECK(part.recording.warnings.size() == all.recording.warnings.size() + 1);
    CHECK_THAT(part.recording.warnings.back().text,
               Contains("of 8000 rows 1600 are examined, in 16 evenly spaced pieces"));
}

}  // namespace

TEST_CASE("of a long log sixteen evenly spread pieces are held, and all of it is accounted for", "[log]") {
    for (const Course& course :
         {Course{}, Course{.gap_before = 3777}, Course{.turn_deg = 360.0}, Course{.sign = -1.0}}) {
        const test::TemporaryPath path;
        write_log(path.string(), course);
        const Log all = read_log(path.string(), {}), part = read_log_in_part(path.string(), {}, 1600);
        check_same(part, all);
        REQUIRE(part.recording.looked_at);
        CHECK(part.recording.looked_at->rows == 1600);
        CHECK(part.recording.looked_at->pieces == 16);
        REQUIRE(part.trace.size() == 1600);
        REQUIRE(part.trace.position_deg.size() == all.trace.position_deg.size() / 5);
        std::size_t at = 0;
        for (std::size_t i = 0; i < part.trace.size(); ++i, ++at) {
            if (i % 100 == 0) at = (8000 - 100) / 15 * (i / 100);
            CHECK(part.trace.time_s[i] == all.trace.time_s[at]);
            CHECK(part.trace.velocity_deg_s[i] == all.trace.velocity_deg_s[at]);
            CHECK(part.trace.torque_nm[i] == all.trace.torque_nm[at]);
            CHECK(part.trace.position_deg[i] == Approx(all.trace.position_deg[at]).epsilon(1e-13));
            const bool starts = part.trace.view().starts_run(i);
            CHECK(starts == ((i > 0 && i % 100 == 0) || (course.gap_before > 0 && at == course.gap_before)));
        }
    }
}

TEST_CASE("a log that can be held is, to the last row", "[log]") {
    const test::TemporaryPath path;
    write_log(path.string(), {});
    const Log all = read_log(path.string(), {}), part = read_log_in_part(path.string(), {}, 8000);
    CHECK_FALSE(part.recording.looked_at);
    CHECK(part.trace.torque_nm == all.trace.torque_nm);
    CHECK(part.recording.warnings.size() == all.recording.warnings.size());
    CHECK(read_log_in_part(path.string(), {}, 7999).recording.looked_at);
}
