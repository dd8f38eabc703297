// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <complex>
#include <cstring>

#include "filter/moves.hpp"
#include "filter/tables.hpp"
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

// Bands of equal ratio rho^2 from 18 deg/s, notches at the geometric middle, Q of the sampled filter.
CandidateTable geometric_table(double q, double rho) {
    TableSpec spec = table_spec();
    spec.q = q;
    spec.width = WidthRule::digital;
    std::vector<Band> bands;
    for (double from = 18.0; from < 45.0; from *= rho * rho) {
        Band band;
        band.number = static_cast<int>(bands.size()) + 1;
        band.from = DegPerSec(from);
        band.to = DegPerSec(from * rho * rho);
        for (const double order : {1.0, 2.0}) {
            const NotchSpec notch{
                .center = Hertz(order * 100.0 * from * rho / 360.0), .q = q, .width = WidthRule::digital};
            band.notches.push_back({Order(order), notch, design_notch(notch, spec.sample_rate)});
        }
        spec.bands.emplace_back(band.from, band.to);
        bands.push_back(std::move(band));
    }
    return CandidateTable::from_bands(spec, std::move(bands));
}

struct RampFigures {
    double rms = 0.0, peak = 0.0, step = 0.0;
    std::size_t switches = 0;
};

RampFigures on_ramp(const std::string& transition, double q, double rho) {
    const Signals s = ramp();
    const CandidateTable table = geometric_table(q, rho);
    const auto filter = start("switching,table=t,transition=" + transition, &table);
    const auto out = filtered(*filter, s.samples());
    RampFigures figures;
    for (std::size_t k = 5000; k < 15000; ++k) {
        figures.rms += std::pow(out[k] - 10.0, 2) / 10000.0;
        figures.peak = std::max(figures.peak, std::abs(out[k] - 10.0));
        if (k > 5000) figures.step = std::max(figures.step, std::abs(out[k] - out[k - 1]));
    }
    figures.rms = std::sqrt(figures.rms);
    figures.switches = filter->switch_count();
    return figures;
}

// Three speeds, one after the other, with a torque that is not constant.
Signals stairs(const std::vector<double>& speeds, std::size_t each) {
    Signals s;
    for (const double speed : speeds) s.velocity_deg_s.insert(s.velocity_deg_s.end(), each, speed);
    for (std::size_t k = 0; k < s.velocity_deg_s.size(); ++k) {
        s.torque_nm.push_back(std::sin(0.11 * static_cast<double>(k)) +
                              0.3 * std::sin(0.37 * static_cast<double>(k)));
        s.position_deg.push_back(0.0);
    }
    return s;
}

}  // namespace

TEST_CASE("transitions on a speed ramp leave what an independent computation leaves, Q 1") {
    const double rho = 1.05151;
    const auto parallel = on_ramp("parallel", 1.0, rho);
    CHECK(parallel.switches == 6);
    CHECK(parallel.rms == Approx(0.07602).margin(1e-5));
    CHECK(parallel.peak == Approx(0.2468).margin(1e-4));
    CHECK(parallel.step == Approx(0.4432).margin(1e-4));
    const auto crossfade = on_ramp("crossfade", 1.0, rho);
    CHECK(crossfade.rms == Approx(0.07387).margin(1e-5));
    CHECK(crossfade.peak == Approx(0.2348).margin(1e-4));
    CHECK(crossfade.step == Approx(0.0195).margin(1e-4));
    const auto integrators = on_ramp("keep-state-variable", 1.0, rho);
    CHECK(integrators.rms == Approx(0.070301).margin(1e-6));
    CHECK(integrators.peak == Approx(0.223677).margin(1e-6));
    CHECK(integrators.step == Approx(0.019512).margin(1e-6));
}

TEST_CASE("transitions on a speed ramp leave what an independent computation leaves, Q 2") {
    const double rho = 1.02544;
    const auto parallel = on_ramp("parallel", 2.0, rho);
    CHECK(parallel.switches == 13);
    CHECK(parallel.rms == Approx(0.09351).margin(1e-5));
    CHECK(parallel.peak == Approx(0.3041).margin(1e-4));
    CHECK(on_ramp("crossfade", 2.0, rho).rms == Approx(0.08632).margin(1e-5));
    CHECK(on_ramp("crossfade", 2.0, rho).peak == Approx(0.2970).margin(1e-4));
    CHECK(on_ramp("keep-state-variable", 2.0, rho).rms == Approx(0.063658).margin(1e-6));
    CHECK(on_ramp("keep-state-variable", 2.0, rho).peak == Approx(0.206521).margin(1e-6));
}

TEST_CASE("switching between equal coefficients is bit-identical to not switching") {
    const CandidateTable table = equal_table(8);
    Signals s = wandering(8000, 23);
    for (double& v : s.velocity_deg_s) v = 1.0 + std::min(std::abs(v), 150.0);
    const auto still = filtered(*start("fixed,centers=20Hz:40Hz,q=0.7"), s.samples());
    for (const char* transition : {"parallel", "keep-state-variable", "crossfade"}) {
        INFO(transition);
        const std::string text = std::string("switching,table=t,transition=") + transition;
        const auto moving = start(text, &table);
        const auto out = filtered(*moving, s.samples());
        CHECK(moving->switch_count() > 20);
        for (const Switch& change : moving->switches()) CHECK(change.jump_nm == 0.0);
        Signals one_speed = s;
        one_speed.velocity_deg_s.assign(8000, 30.0);
        const auto unmoved = filtered(*start(text, &table), one_speed.samples());
        CHECK(std::memcmp(out.data(), unmoved.data(), out.size() * sizeof(double)) == 0);
        double worst = 0.0;
        for (std::size_t k = 0; k < out.size(); ++k) worst = std::max(worst, std::abs(out[k] - still[k]));
        CHECK(worst < 1e-12);  // the state-variable form rounds differently
    }
}

// But for rounding: a table runs in the state-variable form, as its export does.
TEST_CASE("parallel gives at each sample the output of the band's own filter, run alone on the whole log") {
    const CandidateTable table = paper_table();
    const Signals s = wandering(9000, 29);
    const auto out = filtered(*start("switching,table=t,transition=parallel", &table), s.samples());
    std::vector<std::vector<double>> alone;
    for (const Band& band : table.bands()) {
        std::string centers;
        for (const CandidateNotch& notch : band.notches) {
            centers += fmt::format("{}{}Hz", centers.empty() ? "" : ":", notch.notch.center.value());
        }
        alone.push_back(filtered(*start("fixed,centers=" + centers), s.samples()));
    }
    bool held = false;
    for (std::size_t k = 0; k < out.size(); ++k) {
        const double speed = std::abs(s.velocity_deg_s[k]);
        const int band = table.find(DegPerSec(speed));
        if (band >= 0) {
            REQUIRE(std::abs(out[k] - alone[static_cast<std::size_t>(band)][k]) < 1e-12);
        } else if (speed <= 18.0) {
            REQUIRE(out[k] == s.torque_nm[k]);
        } else {
            held = true;
            REQUIRE(std::abs(out[k] - alone.back()[k]) < 1e-12);
        }
    }
    CHECK(held);
}

TEST_CASE("a band reaches from just above its lower speed up to and including its upper speed") {
    const CandidateTable table = paper_table();
    for (const Band& band : table.bands()) {
        for (const double sign : {1.0, -1.0}) {
            Signals s = stairs({5.0, sign * band.to.value()}, 10);
            const auto filter = start("switching,table=t", &table);
            filtered(*filter, s.samples());
            REQUIRE(filter->switches().size() == 1);
            CHECK(filter->switches()[0].to_band == band.number);
            CHECK(filter->switches()[0].from_band == 0);
            CHECK(filter->switches()[0].sample == 10);
            CHECK(filter->switches()[0].speed_deg_s == sign * band.to.value());
        }
    }
}

TEST_CASE("the ledger's jump is the output less what the filter before would have put out") {
    const CandidateTable table = paper_table();
    const Signals s = stairs({30.0, 50.0, 10.0, 90.0}, 200);
    for (const char* transition : {"parallel", "keep-state-variable", "crossfade"}) {
        INFO(transition);
        const std::string text = std::string("switching,table=t,transition=") + transition;
        const auto filter = start(text, &table);
        const auto out = filtered(*filter, s.samples());
        REQUIRE(filter->switches().size() == 3);
        for (const Switch& change : filter->switches()) {
            // The same log, but the speed stays for one sample more: that is what would have been put out.
            Signals unchanged = s;
            unchanged.velocity_deg_s[change.sample] = s.velocity_deg_s[change.sample - 1];
            const auto other = filtered(*start(text, &table), unchanged.samples());
            CHECK(change.jump_nm == Approx(out[change.sample] - other[change.sample]).margin(1e-14));
        }
        CHECK(filter->switches()[1].to_band == 0);
        CHECK(filter->switches()[2].from_band == 0);
    }
}

TEST_CASE("with hysteresis a band is left only when the speed is that far outside it") {
    const CandidateTable table = paper_table();
    const Signals s = stairs({35.0, 37.9, 38.1, 34.1, 33.9}, 10);
    const auto count = [&](const std::string& text) {
        const auto filter = start(text, &table);
        filtered(*filter, s.samples());
        return filter->switch_count();
    };
    CHECK(count("switching,table=t") == 2);                    // 35 | 37.9 38.1 | 34.1 33.9
    CHECK(count("switching,table=t,hysteresis=2deg/s") == 2);  // leaves at 38.1 and at 33.9
    CHECK(count("switching,table=t,hysteresis=2.2deg/s") == 0);
    CHECK_THROWS_AS(start("switching,table=t,hysteresis=-1deg/s", &table), UsageError);
}

TEST_CASE("with a dwell time no two switches are nearer than that") {
    const CandidateTable table = paper_table();
    std::vector<double> speeds;
    for (int k = 0; k < 200; ++k) speeds.push_back(k % 2 == 0 ? 35.0 : 37.0);
    const Signals s = stairs(speeds, 7);
    for (const std::size_t dwell : {1U, 10U, 25U, 300U}) {
        const auto filter = start(fmt::format("switching,table=t,dwell={}ms", dwell), &table);
        filtered(*filter, s.samples());
        REQUIRE(filter->switch_count() > 1);
        CHECK(filter->switches()[0].sample == 7);  // the first choice is not a switch
        for (std::size_t i = 1; i < filter->switches().size(); ++i) {
            CHECK(filter->switches()[i].sample - filter->switches()[i - 1].sample >= dwell);
        }
    }
}

TEST_CASE("outside the bands the torque passes, or the filter holds, or it fades over half the edge speed") {
    const CandidateTable table = paper_table();
    const Signals s = stairs({90.0, 8.0, 0.0, 300.0}, 300);
    const auto band4 = filtered(*start("fixed,centers=22.5Hz:45Hz"), s.samples());
    const auto pass =
        filtered(*start("switching,table=t,transition=parallel,below=pass,above=pass", &table), s.samples());
    const auto hold =
        filtered(*start("switching,table=t,transition=parallel,below=hold,above=hold", &table), s.samples());
    for (std::size_t k = 0; k < s.torque_nm.size(); ++k) {
        if (k < 300)
            REQUIRE(std::abs(pass[k] - band4[k]) < 1e-12);
        else
            REQUIRE(pass[k] == s.torque_nm[k]);
        REQUIRE(std::abs(hold[k] - band4[k]) < 1e-12);
    }
    Signals sweep = stairs({20.0}, 2000);
    for (std::size_t k = 0; k < 2000; ++k)
        sweep.velocity_deg_s[k] = 0.02 * static_cast<double>(k);  // 0 to 40 deg/s
    const auto fade =
        filtered(*start("switching,table=t,transition=parallel,below=fade", &table), sweep.samples());
    const auto band1 = filtered(*start("fixed,centers=7.5Hz:15Hz"), sweep.samples());
    for (std::size_t k = 0; k < 1800; ++k) {
        const double share = std::clamp((sweep.velocity_deg_s[k] - 9.0) / 9.0, 0.0, 1.0);
        REQUIRE(fade[k] ==
                Approx(sweep.torque_nm[k] + share * (band1[k] - sweep.torque_nm[k])).margin(1e-12));
    }
}

TEST_CASE("holding before any band was used means no filter, and a gap forgets what was held") {
    const CandidateTable table = paper_table();
    const Signals s = stairs({300.0, 90.0, 300.0}, 50);
    const auto filter = start("switching,table=t,above=hold", &table);
    const auto out = filtered(*filter, s.samples());
    CHECK(std::equal(out.begin(), out.begin() + 50, s.torque_nm.begin()));
    CHECK(filter->switch_count() == 1);
    CHECK(out[140] != s.torque_nm[140]);
    filter->restart();
    CHECK(filtered(*filter, s.part(100, 50)) ==
          std::vector<double>(s.torque_nm.begin() + 100, s.torque_nm.end()));
}

TEST_CASE("speed regions cover every speed, in order, and agree with the table") {
    TableSpec spec = table_spec({Order(1.0)});
    spec.bands = {{DegPerSec(20.0), DegPerSec(30.0)},
                  {DegPerSec(30.0), DegPerSec(50.0)},
                  {DegPerSec(80.0), DegPerSec(90.0)}};
    const CandidateTable table = CandidateTable::design(spec);
    for (const OutsideRule rule : {OutsideRule::pass, OutsideRule::hold, OutsideRule::fade}) {
        const auto regions = speed_regions(table.bands(), rule, rule);
        CHECK(regions.front().from_deg_s < 0.0);
        CHECK(std::isinf(regions.back().to_deg_s));
        for (std::size_t i = 1; i < regions.size(); ++i) {
            CHECK(regions[i].from_deg_s == regions[i - 1].to_deg_s);
            if (rule == OutsideRule::fade) {
                const double edge = regions[i].from_deg_s;
                CHECK(regions[i].share(edge) == Approx(regions[i - 1].share(edge)).margin(1e-12));
            }
        }
        for (double speed = 0.0; speed < 120.0; speed += 0.5) {
            const int band = table.find(DegPerSec(speed));
            for (const SpeedRegion& region : regions) {
                if (speed <= region.from_deg_s || speed > region.to_deg_s) continue;
                if (band >= 0) CHECK(region.candidate == band);
                if (band < 0 && rule == OutsideRule::pass) CHECK(region.candidate == no_candidate);
                CHECK(region.holds == (band < 0 && rule == OutsideRule::hold));
            }
        }
    }
}

TEST_CASE(
    "a crossfade takes its stated time and moves linearly, also when the speed changes again meanwhile") {
    const CandidateTable table = paper_table();
    const Signals s = stairs({30.0, 50.0, 70.0}, 40);
    const auto out =
        filtered(*start("switching,table=t,transition=crossfade,crossfade=100ms", &table), s.samples());
    const auto a = filtered(*start("fixed,centers=7.5Hz:15Hz"), s.samples());
    const auto b = filtered(*start("fixed,centers=12.5Hz:25Hz"), s.samples());
    const auto c = filtered(*start("fixed,centers=17.5Hz:35Hz"), s.samples());
    for (std::size_t k = 0; k < 120; ++k) {
        double expected = a[k];
        if (k >= 40) {
            const double into_b = static_cast<double>(std::min<std::size_t>(k, 79) - 39) / 100.0;
            expected = (1.0 - into_b) * a[k] + into_b * b[k];
            if (k >= 80) {
                const double into_c = static_cast<double>(k - 79) / 100.0;
                expected = (1.0 - into_c) * expected + into_c * c[k];
            }
        }
        REQUIRE(out[k] == Approx(expected).margin(1e-13));
    }
}

// The notch that follows the speed, against figures worked out independently (SciPy, Octave) and against the
// formulas of the firmwares whose rules it takes over.

namespace {

const std::string gear = "tracking,gear-ratio=100,orders=1:2";

struct Left {
    double hold = 0.0, ramp = 0.0,
           peak = 0.0;  ///< Nm: rms of 2 to 5 and 17 to 20 s, rms and largest of 5 to 15 s
};

Left left_on(const Signals& s, const std::string& text) {
    const auto out = filtered(*start(text), s.samples());
    const std::vector<double> truth(out.size(), 10.0);
    Left left{
        std::hypot(rms_error(out, truth, 2000, 5000), rms_error(out, truth, 17000)) / std::numbers::sqrt2,
        rms_error(out, truth, 5000, 15000), 0.0};
    for (std::size_t k = 5000; k < 15000; ++k) left.peak = std::max(left.peak, std::abs(out[k] - 10.0));
    return left;
}

Signals late(Signals s, std::size_t samples) {
    for (std::size_t k = s.velocity_deg_s.size(); k-- > samples;)
        s.velocity_deg_s[k] = s.velocity_deg_s[k - samples];
    return s;
}

FrozenFilter frozen_at(const std::string& text, double line_hz, Hertz sample_rate = Hertz(1000.0)) {
    const Spec spec = parse_spec(text);
    const Method& method = find_method(spec.name);
    return method.frozen(Settings("method", spec, method.keys), sample_rate, nullptr,
                         DegPerSec(3.6 * line_hz));
}

double gain_db(const std::string& text, double line_hz, double at_hz) {
    const double gain =
        std::abs(response(frozen_at(text, line_hz).cascade, Hertz(at_hz), SampledAt(Hertz(1000.0))));
    return 20.0 * std::log10(std::max(gain, 1e-20));
}

double lag_deg(const std::string& text, double line_hz, double at_hz) {
    const auto cascade = frozen_at(text, line_hz, Hertz(2000.0)).cascade;
    // Step by step, so that a lag beyond half a turn is counted in full.
    double lag = 0.0;
    std::complex<double> before = 1.0;
    for (int i = 1; i <= 200; ++i) {
        const auto now = response(cascade, Hertz(at_hz * i / 200.0), SampledAt(Hertz(2000.0)));
        lag -= std::arg(now / before) * 180.0 / std::numbers::pi;
        before = now;
    }
    return lag;
}

}  // namespace

TEST_CASE(
    "on a ramp from 20 to 40 deg/s a notch retuned every sample leaves less than a thousandth of a "
    "newton-metre") {
    for (const char* q : {"q=1", "q=2", "q=2.5", "q=4"}) {
        const Left left = left_on(ramp(), fmt::format("{},{}", gear, q));
        INFO(q);
        CHECK(left.ramp < 1e-4);
        CHECK(left.peak < 1e-3);
        CHECK(left.hold < 1e-4);
    }
    CHECK(left_on(ramp(), gear + ",q=1").peak < 5e-5);
}

TEST_CASE("what a wrong speed costs a retuned notch is what an independent computation gives") {
    // Without the fade: 2 deg/s of noise would move 20 deg/s in and out of it.
    const std::string off = ",min=0.5Hz,fade=0Hz", q1 = gear + ",q=1" + off;
    const auto near = [](double value) { return Approx(value).epsilon(0.2); };
    const Left late10 = left_on(late(ramp(), 10), q1), late50 = left_on(late(ramp(), 50), q1);
    CHECK(late10.ramp == near(0.0019));
    CHECK(late10.peak == near(0.0047));
    CHECK(late50.ramp == near(0.0093));
    CHECK(late50.peak == near(0.0233));
    const std::string wrong = "tracking,gear-ratio=102,orders=1:2" + off;
    const Left wrong1 = left_on(ramp(), wrong + ",q=1"), wrong2 = left_on(ramp(), wrong + ",q=2");
    CHECK(wrong1.hold == near(0.0523));
    CHECK(wrong1.ramp == near(0.0524));
    CHECK(wrong1.peak == near(0.0945));
    CHECK(wrong2.hold == near(0.118));
    CHECK(wrong2.ramp == near(0.119));
    CHECK(wrong2.peak == near(0.202));
    for (const auto& [noise, hold, on_ramp] :
         {std::tuple{0.5, 0.0069, 0.0057}, std::tuple{2.0, 0.0221, 0.0224}}) {
        Left mean;
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            Signals s = ramp();
            add_white_noise(s.velocity_deg_s, noise, seed, NoiseChannel::velocity);
            const Left left = left_on(s, q1);
            mean.hold += left.hold / 5.0;
            mean.ramp += left.ramp / 5.0;
        }
        CHECK(mean.hold == near(hold));
        CHECK(mean.ramp == near(on_ramp));
    }
}

TEST_CASE("a noisy speed is better low-passed") {
    Signals s = ramp();
    add_white_noise(s.velocity_deg_s, 2.0, 3, NoiseChannel::velocity);
    const std::string text = gear + ",q=1,min=0.5Hz,fade=0Hz";
    CHECK(left_on(s, text + ",speed-lowpass=2Hz").hold < 0.7 * left_on(s, text).hold);
}

TEST_CASE("low=fade follows Betaflight's weight: min 100 Hz, fade 50 Hz") {
    const std::string text = "tracking,gear-ratio=100,orders=1,q=5,min=100Hz,fade=50Hz";
    CHECK(frozen_at(text, 100.0).cascade.empty());
    CHECK(gain_db(text, 110.0, 110.0) == Approx(-1.938).margin(0.001));
    CHECK(gain_db(text, 125.0, 125.0) == Approx(-6.021).margin(0.001));
    CHECK(gain_db(text, 140.0, 140.0) == Approx(-13.979).margin(0.001));
    CHECK(gain_db(text, 150.0, 150.0) < -200.0);
    // Q 5 at 300 Hz: 60 Hz between the -3 dB edges of the prototype.
    CHECK(gain_db("tracking,gear-ratio=100,orders=1,q=5", 30.0, 30.0) < -200.0);
}

TEST_CASE("a weight takes its share of each order and no more") {
    const std::string text = gear + ",weights=1:0.5";
    CHECK(gain_db(text, 50.0, 50.0) < -200.0);
    const double alone = gain_db("tracking,gear-ratio=100,orders=1", 50.0, 100.0);
    CHECK(gain_db(text, 50.0, 100.0) - alone == Approx(-6.021).margin(0.001));
    CHECK(frozen_at(gear + ",weights=0:0", 50.0).cascade.empty());
}

TEST_CASE(
    "low=park follows ArduPilot below the minimum: the centre stays, the depth ends at a quarter of it") {
    const std::string text = "tracking,gear-ratio=100,orders=1,q=1.714285714,depth=40dB,min=80Hz,low=park";
    const double hz[] = {80.0, 65.0, 50.0, 35.0}, db[] = {-40.0, -19.53, -10.39, -4.43};
    for (int i = 0; i < 4; ++i) CHECK(gain_db(text, hz[i], 80.0) == Approx(db[i]).margin(0.01));
    CHECK(frozen_at(text, 20.0).cascade.empty());
    // Their defaults above the minimum (80 Hz, bandwidth 40 Hz, 40 dB).
    const double at[] = {60.0, 70.0, 90.0, 100.0}, expected[] = {-2.868, -7.322, -8.155, -3.990};
    for (int i = 0; i < 4; ++i) CHECK(gain_db(text, 80.0, at[i]) == Approx(expected[i]).margin(0.001));
}

TEST_CASE("double notches on four harmonics lag as ArduPilot's do, single ones more") {
    // Eight such filters in series: 46 Hz, bandwidth 23 Hz, 60 dB, 2 kHz.
    const std::string text =
        "tracking,gear-ratio=100,orders=1:2:3:4,q=1.7142857142857142,depth=60dB,composite=";
    const double at[] = {1.0, 2.0, 5.0, 10.0};
    const double twice[] = {11.022, 22.062, 55.462, 113.199}, once[] = {11.999, 24.015, 60.339, 122.904};
    for (int i = 0; i < 4; ++i) {
        CHECK(8.0 * lag_deg(text + "double", 46.0, at[i]) == Approx(twice[i]).margin(0.01));
        CHECK(8.0 * lag_deg(text + "single", 46.0, at[i]) == Approx(once[i]).margin(0.01));
    }
    CHECK(frozen_at(text + "triple", 46.0).cascade.size() == 12);
}

TEST_CASE("a slew limit lets a centre move by at most its share from sample to sample") {
    Signals jump;
    for (std::size_t k = 0; k < 400; ++k) {
        jump.velocity_deg_s.push_back(k < 100 ? 60.0 : k < 250 ? 120.0 : 30.0);
        jump.position_deg.push_back(0.0);
        jump.torque_nm.push_back(std::sin(0.3 * static_cast<double>(k)) +
                                 std::sin(0.11 * static_cast<double>(k)));
    }
    Signals gentle = jump;
    for (std::size_t k = 1; k < 400; ++k) {
        const double now = gentle.velocity_deg_s[k - 1];
        gentle.velocity_deg_s[k] = std::clamp(jump.velocity_deg_s[k], 0.95 * now, now / 0.95);
    }
    const auto limited = filtered(*start(gear + ",slew=0.05"), jump.samples());
    const auto expected = filtered(*start(gear), gentle.samples());
    const auto free = filtered(*start(gear), jump.samples());
    double worst = 0.0, differs = 0.0;
    for (std::size_t k = 0; k < 400; ++k) {
        worst = std::max(worst, std::abs(limited[k] - expected[k]));
        differs = std::max(differs, std::abs(limited[k] - free[k]));
    }
    CHECK(worst < 1e-9);
    CHECK(differs > 0.01);
}

TEST_CASE("through a reversal the notch leaves what low speed leaves, and nothing builds up") {
    // -40 to 40 deg/s in 10 s; 10 + 5 sin(2 pi 0.2 t) Nm, ripple of 2 and 1 Nm.
    Signals s;
    std::vector<double> truth;
    double angle = 0.0;
    for (std::size_t k = 0; k < 20000; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double v = std::clamp(8.0 * (t - 10.0), -40.0, 40.0);
        angle += v / 1000.0;
        const double theta = 100.0 * angle * std::numbers::pi / 180.0;
        truth.push_back(10.0 + 5.0 * std::sin(2.0 * std::numbers::pi * 0.2 * t));
        s.velocity_deg_s.push_back(v);
        s.position_deg.push_back(angle);
        s.torque_nm.push_back(truth.back() + 2.0 * std::sin(theta + 0.3) + std::sin(2.0 * theta + 1.1));
    }
    for (const auto* rule :
         {"min=1Hz,fade=1Hz", "min=2Hz,fade=2Hz", "min=1Hz,low=park", "min=4Hz,fade=1.5Hz"}) {
        INFO(rule);
        const auto out = filtered(*start(gear + ",q=1," + rule), s.samples());
        const double left = rms_error(out, truth, 9000, 11000);
        CHECK(left > 0.5);
        CHECK(left < 2.6);
        for (const double y : out) REQUIRE(std::abs(y) < 25.0);
    }
}

TEST_CASE(
    "on the paper's move the default tracking notch leaves 0.27 Nm of 0.65, at Q 4 without fading 0.32") {
    double raw = 0.0, q4 = 0.0, usual = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const KnownMove move = paper_move(seed);
        raw += rms_error(move.signals.torque_nm, move.true_nm) / 5.0;
        q4 += rms_error(filtered(*start(gear + ",q=4,min=0.5Hz,fade=0Hz"), move.signals.samples()),
                        move.true_nm) /
              5.0;
        usual += rms_error(filtered(*start(gear), move.signals.samples()), move.true_nm) / 5.0;
    }
    CHECK(raw == Approx(0.65).margin(0.01));
    CHECK(q4 == Approx(0.32).margin(0.01));
    CHECK(usual < 0.28);
}

TEST_CASE("max-delay narrows a slow line's notch until its delay is that, and leaves a fast one's as it is") {
    const auto delay_ms = [](const std::string& text, double line_hz) {
        return 1e3 *
               group_delay(frozen_at(text, line_hz).cascade, Hertz(0.0), SampledAt(Hertz(1000.0))).value();
    };
    const auto rule = [](double hz, double q) { return 1e3 / (2.0 * std::numbers::pi * hz * q); };
    const std::string one = "tracking,gear-ratio=100,orders=1";
    for (const double hz : {6.0, 8.0, 12.0, 15.0}) {
        CHECK(delay_ms(one + ",q=2,max-delay=5ms", hz) == Approx(5.0).epsilon(2e-3));
        CHECK(delay_ms(one + ",q=2", hz) == Approx(rule(hz, 2.0)).epsilon(5e-3));
        CHECK(delay_ms(one, hz) == Approx(4.5).epsilon(2e-3));
    }
    for (const double hz : {17.0, 40.0}) {
        CHECK(delay_ms(one + ",q=2,max-delay=5ms", hz) == delay_ms(one + ",q=2", hz));
        CHECK(gain_db(one + ",max-delay=5ms", hz, hz) < -200.0);
    }
    CHECK(delay_ms(one, 60.0) == delay_ms(one + ",q=1.7", 60.0));
}

TEST_CASE("tracking says what is wrong with its settings") {
    CHECK_THROWS_WITH(start("tracking,orders=1"), Catch::Contains("gear-ratio"));
    CHECK_THROWS_WITH(start(gear + ",weights=1"), Catch::Contains("1 values for 2 orders"));
    CHECK_THROWS_WITH(start(gear + ",weights=1:-0.5"), Catch::Contains("weights: -0.5 is below 0"));
    CHECK_THROWS_WITH(start(gear + ",fade=-1Hz"), Catch::Contains("fade: -1Hz is below 0 Hz"));
    CHECK_THROWS_WITH(start("tracking,gear-ratio=100,orders=2:1:2"), Catch::Contains("2 is given twice"));
    CHECK_THROWS_WITH(start(gear + ",min=460Hz"), Catch::Contains("450 Hz"));
    CHECK_THROWS_AS(start("tracking,gear-ratio=0,orders=1"), UsageError);
}

TEST_CASE("a line that nears half the sample rate is let go before it gets there") {
    const std::string text = "tracking,gear-ratio=100,orders=1";
    CHECK(gain_db(text, 440.0, 440.0) < -200.0);
    CHECK(gain_db(text, 465.0, 465.0) == Approx(-6.021).margin(0.001));
    CHECK(frozen_at(text, 490.0).cascade.empty());
}
