// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <regex>
#include <set>
#include <sstream>

#include "model/motion/local_motion.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
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

namespace {

// What a log of a motion holds; position only when asked for.
Trace logged(const Motion& motion, bool with_position) {
    Trace trace{.source = "log",
                .joint = {},
                .sample_rate = motion.sample_rate,
                .time_s = motion.time_s,
                .velocity_deg_s = motion.velocity_deg_s,
                .torque_nm = std::vector<double>(motion.size(), 0.0),
                .position_deg = {}};
    if (with_position) trace.position_deg = motion.position_deg;
    return trace;
}

double largest_error(const std::vector<double>& a, const std::vector<double>& b, std::size_t margin) {
    double most = 0.0;
    for (std::size_t k = margin; k + margin < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
    return most;
}

const std::vector<std::string> two_moves = {"rest,duration=0.5s", "poly6,to=120deg,duration=2s",
                                            "rest,duration=0.5s", "poly6,to=-40deg,duration=2.5s",
                                            "rest,duration=0.5s"};

// A log of it, its speed noisy, its position that of an encoder.
Trace with_encoder(const Motion& motion, int bits, std::uint64_t seed) {
    Trace log = logged(motion, true);
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> noise(0.0, 0.15);
    for (double& v : log.velocity_deg_s) v += noise(engine);
    const double step_deg = 360.0 / std::ldexp(1.0, bits);
    for (double& q : log.position_deg) q = step_deg * std::round(q / step_deg);
    return log;
}

double rms_error(const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) squares += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(squares / static_cast<double>(a.size()));
}

Trace without_position(Trace log) {
    log.position_deg.clear();
    return log;
}

}  // namespace

TEST_CASE("speed and acceleration are exact where the speed is a cubic in time, at the ends too") {
    Motion m = make_motion("rest,duration=0.5s", 400_Hz);
    for (std::size_t k = 0; k < m.size(); ++k) {
        const double t = m.time_s[k];
        m.position_deg[k] = t * (3.0 + t * (-10.0 + t * (70.0 / 3.0 - 25.0 * t)));
        m.velocity_deg_s[k] = 3.0 - 20.0 * t + 70.0 * t * t - 100.0 * t * t * t;
        m.acceleration_deg_s2[k] = -20.0 + 140.0 * t - 300.0 * t * t;
    }
    const Motion measured = motion_along(logged(m, true).view());
    CHECK(largest_error(measured.velocity_deg_s, m.velocity_deg_s, 0) < 1e-10);
    CHECK(largest_error(measured.acceleration_deg_s2, m.acceleration_deg_s2, 0) < 1e-8);
    CHECK(measured.position_deg == m.position_deg);
    std::fill(m.position_deg.begin(), m.position_deg.end(), 12.5);
    const Motion still = motion_along(logged(m, true).view());
    CHECK(largest_error(still.velocity_deg_s, std::vector<double>(m.size()), 0) == 0.0);
}

TEST_CASE(
    "a swing keeps its speed and acceleration within what the header states, and is not shifted in time") {
    // 8 Hz * 50 ms = 0.4.
    const Motion m = make_motion("sine,amplitude=5deg,frequency=8Hz,duration=3s", 1000_Hz);
    const Motion measured = motion_along(logged(m, true).view());
    const double speed = 5.0 * 2.0 * 3.14159265 * 8.0, acceleration = speed * 2.0 * 3.14159265 * 8.0;
    CHECK(largest_error(measured.velocity_deg_s, m.velocity_deg_s, 26) < 0.01 * speed);
    CHECK(largest_error(measured.acceleration_deg_s2, m.acceleration_deg_s2, 26) < 0.02 * acceleration);
    // Half a sample of shift would be an acceleration off by 2.5 % at the zero crossings: the products with
    // the quadrature of each signal say how much there is.
    double speed_shift = 0.0, acceleration_shift = 0.0, scale = 0.0;
    for (std::size_t k = 250; k < 2750; ++k) {
        speed_shift += measured.velocity_deg_s[k] * m.acceleration_deg_s2[k] / acceleration;
        acceleration_shift += measured.acceleration_deg_s2[k] * m.velocity_deg_s[k] / acceleration;
        scale += m.velocity_deg_s[k] * m.velocity_deg_s[k] / speed;
    }
    CHECK(std::abs(speed_shift / scale) < 1e-9);
    CHECK(std::abs(acceleration_shift / scale) < 1e-9);
}

TEST_CASE("without a position it is the integral of the speed, from 0, neither early nor late") {
    const std::vector<std::string> specs = {"poly6,to=90deg,duration=1s", "poly6,to=-40deg,duration=1.3s"};
    const Motion m = make_motion(specs, 1000_Hz);
    const Motion measured = motion_along(logged(m, false).view());
    // The trapezoidal rule errs by step^2 / 12 times the change of acceleration, here below 1e-6 / 12 * 500.
    CHECK(largest_error(measured.position_deg, m.position_deg, 0) < 5e-5);
}

TEST_CASE("times with jitter and a gap are taken as they are") {
    Motion m = make_motion("sine,amplitude=30deg,frequency=0.5Hz,duration=4s", 1000_Hz);
    std::mt19937_64 engine(2);
    std::uniform_real_distribution<double> jitter(-0.3e-3, 0.3e-3);
    for (std::size_t k = 0; k < m.size(); ++k) {
        m.time_s[k] += jitter(engine) + (k > 2000 ? 0.02 : 0.0);
        const double angle = 2.0 * 3.141592653589793 * 0.5 * m.time_s[k];
        m.velocity_deg_s[k] = 94.24777960769379 * std::sin(angle);
        m.acceleration_deg_s2[k] = 296.0881320326807 * std::cos(angle);
        m.position_deg[k] = 30.0 * (1.0 - std::cos(angle));
    }
    const Motion measured = motion_along(logged(m, false).view());
    CHECK(largest_error(measured.velocity_deg_s, m.velocity_deg_s, 0) < 1e-3);
    CHECK(largest_error(measured.acceleration_deg_s2, m.acceleration_deg_s2, 26) < 0.05);
    const double offset = m.position_deg[0];
    for (std::size_t k = 0; k < m.size(); ++k)
        REQUIRE(measured.position_deg[k] == Approx(m.position_deg[k] - offset).margin(0.005));
}

TEST_CASE("noise on the velocity is smoothed as a cubic over the window does") {
    Motion m = make_motion("constant,speed=40deg/s,duration=40s", 1000_Hz);
    std::mt19937_64 engine(4);
    std::normal_distribution<double> noise(0.0, 0.15);
    for (double& v : m.velocity_deg_s) v += noise(engine);
    const Motion measured = motion_along(logged(m, false).view());
    double speed = 0.0, acceleration = 0.0;
    for (std::size_t k = 100; k + 100 < m.size(); ++k) {
        speed += std::pow(measured.velocity_deg_s[k] - 40.0, 2);
        acceleration += measured.acceleration_deg_s2[k] * measured.acceleration_deg_s2[k];
    }
    const double count = static_cast<double>(m.size() - 200);
    // 51 samples: the variance of the value is 9 / (4 n), that of the slope 75 / n^3 rate^2, for many
    // samples.
    CHECK(std::sqrt(speed / count) == Approx(0.15 * std::sqrt(9.0 / 4.0 / 51.0)).epsilon(0.05));
    CHECK(std::sqrt(acceleration / count) ==
          Approx(0.15 * 1000.0 * std::sqrt(75.0 / (51.0 * 51.0 * 51.0))).epsilon(0.05));
}

TEST_CASE("a rest is a rest, whatever the noise on its speed, and a slow motion is none") {
    std::mt19937_64 engine(5);
    std::normal_distribution<double> noise(0.0, 0.15);
    for (const double speed_deg_s : {0.0, 0.3, -1.0}) {
        const std::string slow = "constant,speed=" + std::to_string(speed_deg_s) + "deg/s,duration=3s";
        const std::vector<std::string> specs = {slow, "poly6,to=40deg,duration=1s"};
        Motion m = make_motion(specs, 1000_Hz);
        for (double& v : m.velocity_deg_s) v += noise(engine);
        const Motion measured = motion_along(logged(m, true).view());
        std::size_t still = 0;
        for (std::size_t k = 0; k < 2900; ++k) still += measured.velocity_deg_s[k] == 0.0 ? 1U : 0U;
        CHECK(still == (speed_deg_s == 0.0 ? 2900U : 0U));
        CHECK(measured.velocity_deg_s[3500] > 20.0);
    }
}

TEST_CASE("a model along a log of its own motion predicts its own torque") {
    const std::vector<std::string> specs = {"rest,duration=0.3s", "poly6,to=120deg,duration=1s",
                                            "rest,duration=0.3s", "poly6,to=-20deg,duration=1.4s",
                                            "rest,duration=0.3s"};
    const Motion m = make_motion(specs, 1000_Hz);
    Model model{GearRatio(100.0), {}};
    for (const auto term :
         {"inertia,inertia_kgm2=0.8", "ripple,order=1,amplitude_nm=0.7,phase_deg=30",
          "ripple,order=2,amplitude_nm=0.4,phase_deg=-50", "hysteresis,torque_nm=0.5,width_deg=1",
          "viscous-friction,coefficient_nm_per_deg_s=0.005", "delay,delay_s=3ms"}) {
        model.terms.push_back(parse_term(term));
    }
    const auto truth = predict_nm(model, m);
    for (const bool with_position : {true, false}) {
        const Trace log = logged(m, with_position);
        CHECK(largest_error(predict_nm(model, motion_along(log.view(), Seconds(0.006))), truth, 0) < 0.03);
        // The move begins with a kink of its acceleration; a window of 50 ms rounds it, by 0.2 Nm for some
        // samples.
        const auto smooth = predict_nm(model, motion_along(log.view()));
        CHECK(largest_error(smooth, truth, 0) < 0.25);
        double square = 0.0;
        for (std::size_t k = 0; k < truth.size(); ++k) square += std::pow(smooth[k] - truth[k], 2);
        CHECK(std::sqrt(square / static_cast<double>(truth.size())) < 0.02);
    }
}

TEST_CASE("noise from sample to sample is told from any motion, and is that of an encoder's steps") {
    const Trace log = with_encoder(make_motion(two_moves, 1000_Hz), 19, 3);
    CHECK(sample_noise(log.velocity_deg_s) == Approx(0.15).epsilon(0.05));
    // A sawtooth of one step while it moves, 4.5 of 6 s, and nothing at rest.
    const double step_deg = 360.0 / std::ldexp(1.0, 19);
    CHECK(sample_noise(log.position_deg) ==
          Approx(step_deg / std::sqrt(12.0) * std::sqrt(0.75)).epsilon(0.1));
    std::vector<double> cubic;
    for (int k = 0; k < 1000; ++k) cubic.push_back(1e-6 * k * k * k);
    CHECK(sample_noise(cubic) < 1e-9);
}

TEST_CASE("the position of a good encoder makes speed and acceleration several times surer") {
    const Motion truth = make_motion("sine,amplitude=30deg,frequency=0.5Hz,duration=8s", 1000_Hz);
    Trace log = with_encoder(truth, 19, 3);
    const Motion with = motion_along(log.view()), without = motion_along(without_position(log).view());
    CHECK(rms_error(with.velocity_deg_s, truth.velocity_deg_s) <
          0.2 * rms_error(without.velocity_deg_s, truth.velocity_deg_s));
    CHECK(rms_error(with.acceleration_deg_s2, truth.acceleration_deg_s2) <
          0.35 * rms_error(without.acceleration_deg_s2, truth.acceleration_deg_s2));
}

TEST_CASE("with the position of a good encoder a rest ends where the move begins") {
    const Motion truth = make_motion(two_moves, 1000_Hz);
    const Motion measured = motion_along(with_encoder(truth, 19, 3).view());
    std::size_t first = 0;
    while (measured.velocity_deg_s[first] == 0.0) ++first;
    CHECK(static_cast<double>(first) == Approx(505.0).margin(15.0));
}

TEST_CASE("a position that is not the speed's integral is not mixed into the speed") {
    const Trace log = with_encoder(make_motion(two_moves, 1000_Hz), 19, 6);
    const Motion alone = motion_along(without_position(log).view());
    Trace late = log, scaled = log, coarse = log;
    for (std::size_t k = 2; k < late.size(); ++k) late.position_deg[k] = log.position_deg[k - 2];
    for (double& q : scaled.position_deg) q *= 1.01;
    for (double& q : coarse.position_deg) q = 5.0 * std::round(q / 5.0);
    for (const Trace& other : {late, scaled}) {
        const Motion measured = motion_along(other.view());
        CHECK(measured.velocity_deg_s == alone.velocity_deg_s);
        CHECK(measured.acceleration_deg_s2 == alone.acceleration_deg_s2);
        CHECK(measured.position_deg == other.position_deg);
    }
    CHECK(rms_error(motion_along(coarse.view()).velocity_deg_s, alone.velocity_deg_s) < 0.005);
}

TEST_CASE("a log that no motion can be measured from is refused with the reason") {
    Trace trace = logged(make_motion("rest,duration=4s", 1_Hz), false);
    CHECK_THROWS_WITH(motion_along(trace.view()), Contains("4 rows") && Contains("at least 5"));
    trace = logged(make_motion("rest,duration=9s", 1_Hz), false);
    trace.time_s[3] = trace.time_s[2];
    CHECK_THROWS_WITH(motion_along(trace.view()), Contains("2 to 2 s after row 3") && Contains("increase"));
    for (double& t : trace.time_s) t = std::nan("");
    CHECK_THROWS_WITH(motion_along(trace.view()), Contains("--sample-rate"));
}

namespace {

struct Stamped {
    std::vector<std::size_t> kept;
    std::vector<double> time_s;
};

// A kilohertz of which three rows in a hundred are lost, with stamps that are off by up to 0.35 of a step.
Stamped stamped(std::size_t count, std::uint32_t seed) {
    std::mt19937 bits(seed);
    Stamped log;
    const auto part = [&] { return static_cast<double>(bits()) / 4294967296.0; };
    for (std::size_t k = 0; k < count; ++k) {
        const double late = 0.35 * (part() - 0.5) + 0.35 * (part() - 0.5);
        if (k > 0 && part() < 0.03) continue;
        log.kept.push_back(k);
        log.time_s.push_back(1e-3 * (static_cast<double>(k) + late));
    }
    return log;
}

}  // namespace

TEST_CASE("rows that are missing are found though stamps jitter") {
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        CAPTURE(seed);
        const Stamped log = stamped(20000, seed);
        double step_s = 0.0;
        const auto places = places_of_rows(log.time_s, step_s);
        REQUIRE(places.size() == log.kept.size());
        CHECK(places == log.kept);
        CHECK(step_s == Approx(1e-3).epsilon(1e-3));
    }
}

TEST_CASE("a log of which nothing is missing has no other clock") {
    double step_s = 0.0;
    std::vector<double> even, cut;
    for (std::size_t k = 0; k < 5000; ++k) even.push_back(1e-3 * static_cast<double>(k));
    CHECK(places_of_rows(even, step_s).empty());
    // Stretches with seconds between them are no lost rows.
    for (std::size_t k = 0; k < 5000; ++k) cut.push_back(even[k] + 3.0 * static_cast<double>(k / 500));
    CHECK(places_of_rows(cut, step_s).empty());
}

TEST_CASE("what is filled in is the signal to the error of a cubic") {
    const std::vector<std::size_t> places = {0, 1, 2, 4, 5, 6, 8, 9, 10};
    std::vector<double> cubic;
    const auto value = [](std::size_t k) {
        const auto x = static_cast<double>(k);
        return 1.0 - 2.0 * x + 0.3 * x * x - 0.02 * x * x * x;
    };
    for (const std::size_t place : places) cubic.push_back(value(place));
    const auto whole = with_lost_rows(cubic, places);
    REQUIRE(whole.size() == 11);
    for (std::size_t k = 0; k < whole.size(); ++k) CHECK(whole[k] == Approx(value(k)));
}

TEST_CASE("a delay along a log that lost rows is that of the whole log") {
    const Motion whole = make_motion("constant,speed=120deg/s,duration=4s", Hertz(1000.0));
    const Stamped log = stamped(whole.size(), 2);
    Motion part = whole;
    part.time_s = log.time_s;
    part.position_deg.clear();
    part.velocity_deg_s.assign(log.kept.size(), 120.0);
    part.acceleration_deg_s2.assign(log.kept.size(), 0.0);
    for (const std::size_t k : log.kept) part.position_deg.push_back(whole.position_deg[k]);
    part.sample_rate = Hertz(970.0);
    for (const char* late : {"delay,delay_s=0.0083", "lag,time_constant_s=0.006"}) {
        CAPTURE(late);
        Model model{GearRatio(100.0), {}};
        model.terms.push_back(parse_term("ripple,order=1,amplitude_nm=1,phase_deg=20"));
        model.terms.push_back(parse_term(late));
        const auto expected = predict_nm(model, whole), found = predict_nm(model, part);
        for (std::size_t k = 200; k + 200 < found.size(); ++k)
            REQUIRE(std::abs(found[k] - expected[log.kept[k]]) < 5e-3);
    }
}
