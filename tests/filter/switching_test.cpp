// SPDX-License-Identifier: MIT
#include <cstring>

#include "filter/tables.hpp"
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
