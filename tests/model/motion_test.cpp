// SPDX-License-Identifier: MIT
#include "ripplenotch/model/motion.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

namespace {

// A specification of each kind, and the same motion turned round. A new kind fails the first law until it is
// here.
struct Example {
    std::string name, spec, reversed;
};
const std::vector<Example> examples = {
    {"rest", "rest,duration=1.5s,from=30deg", "rest,duration=1.5s,from=-30deg"},
    {"constant", "constant,speed=60deg/s,duration=1.5s", "constant,speed=-60deg/s,duration=1.5s"},
    {"ramp", "ramp,from-speed=-10deg/s,to-speed=60deg/s,duration=1.5s",
     "ramp,from-speed=10deg/s,to-speed=-60deg/s,duration=1.5s"},
    {"poly6", "poly6,from=90deg,to=-90deg,duration=2s,asymmetry=0.3",
     "poly6,from=-90deg,to=90deg,duration=2s,asymmetry=0.3"},
    {"sine", "sine,amplitude=20deg,frequency=0.7Hz,duration=3s,phase=0deg",
     "sine,amplitude=20deg,frequency=0.7Hz,duration=3s,phase=180deg"},
    {"sweep", "sweep,amplitude=20deg,from-frequency=0.1Hz,to-frequency=0.6Hz,duration=3s,phase=20deg",
     "sweep,amplitude=20deg,from-frequency=0.1Hz,to-frequency=0.6Hz,duration=3s,phase=200deg"},
    {"multisine", "multisine,amplitude=10deg,frequency=0.2Hz,count=4,duration=3s",
     "multisine,amplitude=10deg,frequency=0.2Hz,count=4,duration=3s,phase=180deg"},
    {"fourier", "fourier,speeds=10deg/s:-4deg/s:3deg/s,duration=3s",
     "fourier,speeds=-10deg/s:4deg/s:-3deg/s,duration=3s"},
};

Motion chain(std::vector<std::string> specs, Hertz rate) { return make_motion(specs, rate); }

double largest(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

}  // namespace

TEST_CASE(
    "every kind of motion is listed once, described, and has an example here and rows of the page with its "
    "equation and keys") {
    std::set<std::string> seen;
    std::ifstream file(source_folder() + "/docs/motions/README.md");
    std::stringstream page;
    page << file.rdbuf();
    for (const MotionKind* kind : motion_kinds()) {
        CAPTURE(kind->name);
        const std::string name(kind->name);
        CHECK(std::regex_match(name, std::regex("[a-z0-9]+(-[a-z0-9]+)*")));
        CHECK(seen.insert(name).second);
        CHECK(!kind->summary.empty());
        CHECK(!kind->equation.empty());
        CHECK(!kind->source.empty());
        CHECK(&find_motion_kind(name) == kind);
        CHECK(
            std::any_of(examples.begin(), examples.end(), [&](const Example& e) { return e.name == name; }));
        CHECK_THAT(page.str(), Contains("| `" + name + "` | `" + std::string(kind->equation) + "` |"));
        for (const Key& key : kind->keys) {
            CAPTURE(key.name);
            CHECK(std::regex_search(page.str(),
                                    std::regex("\\n\\| [^|\n]*(`" + name + "`|all)[^|\n]*\\|[^|\n]*`" +
                                               std::string(key.name) + "`")));
        }
    }
}

TEST_CASE("speed is the derivative of position and acceleration that of speed, in every kind of motion") {
    for (const Example& example : examples) {
        CAPTURE(example.spec);
        const Motion m = make_motion(example.spec, 1000_Hz);
        for (std::size_t k = 1; k + 1 < m.size(); ++k) {
            // Central differences err by step^2 / 6 times the third derivative: below 1e-4 of these motions'
            // peaks.
            const double speed = (m.position_deg[k + 1] - m.position_deg[k - 1]) * 500.0;
            const double acceleration = (m.velocity_deg_s[k + 1] - m.velocity_deg_s[k - 1]) * 500.0;
            REQUIRE(std::abs(speed - m.velocity_deg_s[k]) < 1e-3);
            REQUIRE(std::abs(acceleration - m.acceleration_deg_s2[k]) < 1e-2);
        }
    }
}

TEST_CASE("a motion turned round is the negative of the motion, bit by bit where nothing is rounded") {
    for (const Example& example : examples) {
        CAPTURE(example.spec);
        const Motion there = make_motion(example.spec, 1000_Hz);
        const Motion back = make_motion(example.reversed, 1000_Hz);
        REQUIRE(there.size() == back.size());
        for (std::size_t k = 0; k < there.size(); ++k) {
            REQUIRE(there.position_deg[k] == Approx(-back.position_deg[k]).margin(1e-12));
            REQUIRE(there.velocity_deg_s[k] == Approx(-back.velocity_deg_s[k]).margin(1e-11));
            REQUIRE(there.acceleration_deg_s2[k] == Approx(-back.acceleration_deg_s2[k]).margin(1e-10));
        }
    }
}

TEST_CASE("time is k / rate to the last bit and the number of samples is duration times rate") {
    for (const double rate : {1.0, 25.0, 100.0, 333.0, 1000.0, 4000.0, 44100.0}) {
        CAPTURE(rate);
        const Motion m = make_motion("constant,speed=1deg/s,duration=7s", Hertz(rate));
        REQUIRE(m.size() == static_cast<std::size_t>(7.0 * rate));
        for (std::size_t k = 0; k < m.size(); ++k) REQUIRE(m.time_s[k] == static_cast<double>(k) / rate);
    }
    // 0.1 + 0.2 is above 0.3 in binary: one sample more would appear if durations were added carelessly.
    CHECK(chain({"rest,duration=0.1s", "rest,duration=0.2s"}, 1000_Hz).size() == 300);
    CHECK(make_motion("rest,duration=0.29s", 100_Hz).size() == 29);
    // Half a sample more is one sample more: time stays below the end.
    CHECK(make_motion("rest,duration=10.5ms", 1000_Hz).size() == 11);
    CHECK(make_motion("rest,duration=1us", 1000_Hz).size() == 1);
}

TEST_CASE("pieces follow one another without a jump in position") {
    const Motion m =
        chain({"rest,duration=0.5s,from=90deg", "poly6,to=-90deg,duration=2s", "rest,duration=0.25s",
               "ramp,to-speed=40deg/s,duration=1s", "constant,speed=40deg/s,duration=0.3333s",
               "ramp,to-speed=0deg/s,duration=0.5s", "sine,amplitude=5deg,frequency=1Hz,duration=1s"},
              1000_Hz);
    CHECK(m.size() == 5584);  // 5.5833 s, rounded up
    CHECK(m.position_deg.front() == 90.0);
    for (std::size_t k = 1; k < m.size(); ++k) {
        REQUIRE(std::abs(m.position_deg[k] - m.position_deg[k - 1]) <=
                0.171);  // the fastest piece in one sample
    }
    // 90 -> -90 deg, then 20 deg of ramp, 13.332 deg at 40 deg/s and 10 deg of ramp; the sine ends where it
    // began.
    CHECK(m.position_deg[4583] == Approx(-90.0 + 20.0 + 13.332 + 10.0).margin(1e-4));
    // A ramp without from-speed goes on at the speed that was.
    CHECK(m.velocity_deg_s[4083] == Approx(40.0).margin(0.1));
}

TEST_CASE("a piece may begin between two samples") {
    const Motion m = chain({"rest,duration=1.5s", "constant,speed=10deg/s,duration=2s"}, 1_Hz);
    CHECK(m.size() == 4);
    CHECK(m.position_deg == std::vector<double>{0.0, 0.0, 5.0, 15.0});
}

TEST_CASE("a constant speed turns by speed times time") {
    const Motion m =
        make_motion("constant,speed=-10rpm,duration=3s,from=1rev", 1000_Hz);  // 10 rpm = 60 deg/s
    CHECK(m.position_deg.front() == 360.0);
    CHECK(m.position_deg.back() == Approx(360.0 - 60.0 * 2.999).epsilon(1e-15));
    CHECK(largest(m.acceleration_deg_s2) == 0.0);
}

TEST_CASE("asymmetry moves the greatest speed and mirrors in time, and the ends stay at rest") {
    for (const double asymmetry : {-1.0, -0.4, 0.0, 0.4, 1.0}) {
        CAPTURE(asymmetry);
        const auto spec = [](double a) {
            return "poly6,to=10deg,duration=1s,asymmetry=" + std::to_string(a);
        };
        const Motion m = make_motion(spec(asymmetry), 1000_Hz);
        const Motion mirrored = make_motion(spec(-asymmetry), 1000_Hz);
        for (std::size_t k = 1; k < m.size(); ++k) {
            REQUIRE(m.velocity_deg_s[k] >= 0.0);
            REQUIRE(m.velocity_deg_s[k] == Approx(mirrored.velocity_deg_s[1000 - k]).margin(1e-9));
        }
        const auto fastest =
            std::max_element(m.velocity_deg_s.begin(), m.velocity_deg_s.end()) - m.velocity_deg_s.begin();
        if (asymmetry > 0.0) CHECK(fastest < 500);
        if (asymmetry < 0.0) CHECK(fastest > 500);
    }
}

TEST_CASE("a sine starts from rest unless a phase is given") {
    const Motion m = make_motion("sine,amplitude=10deg,frequency=1Hz,duration=2s,from=3deg", 1000_Hz);
    CHECK(m.velocity_deg_s.front() == 0.0);
    CHECK(m.position_deg.front() == 3.0);
    CHECK(m.position_deg[500] == 23.0);
    CHECK(m.position_deg[1000] == 3.0);
}

TEST_CASE("a wrong motion is refused with the piece and the remedy") {
    const auto refusal = [](std::vector<std::string> specs) {
        try {
            (void)make_motion(specs, 1000_Hz);
        } catch (const UsageError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    CHECK_THAT(refusal({}), Contains("no motion is given"));
    CHECK_THAT(refusal({"polly6,to=1,duration=1s"}), Contains("did you mean poly6?"));
    CHECK_THAT(refusal({"constant,speed=60deg/s"}), Contains("needs duration=..."));
    CHECK_THAT(refusal({"constant,duration=1s"}), Contains("needs speed=..."));
    CHECK_THAT(refusal({"constant,speed=60Nm,duration=1s"}),
               Contains("has the unit 'Nm'") && Contains("rpm"));
    CHECK_THAT(refusal({"constant,speed=60,duration=0s"}), Contains("not above 0 s"));
    CHECK_THAT(refusal({"constant,speed=60,duration=-1s"}), Contains("not above 0 s"));
    CHECK_THAT(refusal({"constant,speed=nan,duration=1s"}), Contains("cannot read 'nan'"));
    CHECK_THAT(refusal({"constant,speed=60,duration=2e5s"}),
               Contains("more than 100000000 samples") && Contains("lower"));
    CHECK_THAT(refusal({"rest,duration=1s", "rest,duration=1s,from=3deg"}),
               Contains("from=3deg") && Contains("ends at 0deg") && Contains("leave from= out"));
    CHECK_THAT(refusal({"poly6,to=1,duration=1s,asymmetry=1.01"}), Contains("1.01 is above the limit of 1"));
    CHECK_THROWS_WITH(make_motion("rest,duration=1s", 0_Hz), Contains("not above 0"));
}

TEST_CASE("a sweep ends at its last frequency, and a multisine keeps within its amplitude and repeats") {
    const Motion m =
        make_motion("sweep,amplitude=10deg,from-frequency=1.03Hz,to-frequency=4.97Hz,duration=4s", 1000_Hz);
    // 1.03 t + 0.4925 t^2 swings: 12 in all, 7.5 of them by 3 s; from rest, one turns at each half swing.
    const auto turns = [&](std::size_t from) {
        int count = 0;
        for (std::size_t k = from + 1; k < m.size(); ++k)
            count += m.velocity_deg_s[k] * m.velocity_deg_s[k - 1] < 0.0;
        return count;
    };
    CHECK(turns(1) == 23);
    CHECK(turns(3000) == 8);
    const Motion s = make_motion("multisine,amplitude=30deg,frequency=0.5Hz,count=7,duration=4s", 1000_Hz);
    const auto [low, high] = std::minmax_element(s.position_deg.begin(), s.position_deg.end());
    CHECK(*high - *low < 60.0);
    for (std::size_t k = 0; k < 2000; ++k)
        REQUIRE(s.position_deg[k] == Approx(s.position_deg[k + 2000]).margin(1e-9));
    CHECK_THROWS_WITH(make_motion("multisine,amplitude=1deg,frequency=1Hz,count=2.5,duration=1s", 10_Hz),
                      Contains("not a whole number"));
}

TEST_CASE("a fourier motion begins and ends at rest, and where the odd half-waves say") {
    const Motion m = make_motion("fourier,speeds=10deg/s:5deg/s:-2deg/s,duration=3s,from=7deg", 1000_Hz);
    CHECK(m.velocity_deg_s.front() == 0.0);
    CHECK(m.velocity_deg_s.back() == Approx(0.0).margin(0.02));
    // An odd half-wave goes 2 T s / (pi k), an even one nowhere.
    CHECK(m.position_deg.back() == Approx(7.0 + 6.0 / 3.14159265 * (10.0 - 2.0 / 3.0)).margin(1e-4));
}
