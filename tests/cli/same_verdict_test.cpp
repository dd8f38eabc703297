// SPDX-License-Identifier: MIT
// A user of the library is told "cannot tell" where the program is, in the same words.
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/readings.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::StartsWith;

namespace {

class Folder {
  public:
    Folder()
        : path_(std::filesystem::temp_directory_path() / fmt::format("ripplenotch-verdict-{}", ::getpid())) {
        std::filesystem::create_directory(path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

// Ripple of orders 1 and 2 behind a gear of 100, in a log that says neither deg/s nor rad/s.
void write_log_without_units(const std::string& path) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise(0.0, 0.05);
    std::ofstream log(path);
    log << "time,velocity,torque,position\n";
    for (int k = 0; k < 6000; ++k) {
        const double t = 0.001 * k, angle = 150.0 / 0.9 * (1.0 - std::cos(0.9 * t));
        const double motor = 100.0 * angle * std::numbers::pi / 180.0;
        log << fmt::format("{:.3f},{:.5f},{:.5f},{:.5f}\n", t, 150.0 * std::sin(0.9 * t),
                           0.8 * std::sin(motor) + 0.5 * std::sin(2.0 * motor) + noise(random), angle);
    }
}

void run_program(const std::string& words) {
    REQUIRE(std::system(fmt::format("'{}' {} -q >/dev/null", RIPPLENOTCH_PROGRAM, words).c_str()) == 0);
}

}  // namespace

TEST_CASE("The library cannot tell what the program cannot tell, in the same words") {
    const Folder folder;
    const std::string path = folder.file("log.csv");
    write_log_without_units(path);
    run_program(fmt::format("identify {} -o {}", path, folder.file("joint.json")));
    run_program(fmt::format("map {} --gear-ratio 100 -o {}", path, folder.file("map.json")));

    ReadOptions options;
    options.takes_motor_units = true;
    const Log log = read_log(path, options);
    const TraceView view = log.trace.view();
    CHECK(identify({&view, 1}, {}).conclusive);  // which is why the readings have to be asked

    const Identification found = identify_readings({&log, 1}, {});
    const Identification of_program = load_identification(folder.file("joint.json"));
    CHECK_THAT(found.verdict, StartsWith("Cannot tell: the log does not state its units"));
    CHECK(found.verdict == of_program.verdict);
    CHECK(found.notes == of_program.notes);
    CHECK_FALSE(found.conclusive);
    CHECK_FALSE(found.gear_ratio.value);

    const auto gear = GearChoice({.ratio = 100.0, .orders = {}, .joint_file = {}}).of();
    const MapFit map = map_readings({&log, 1}, *gear, Degrees(0.0));
    const MapFit map_of_program = load_map(folder.file("map.json"));
    CHECK(map.doubt == map_of_program.doubt);
    CHECK(map.conclusive == map_of_program.conclusive);
}
