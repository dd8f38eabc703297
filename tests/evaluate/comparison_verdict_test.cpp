// SPDX-License-Identifier: MIT

#include "ripplenotch/evaluate/comparison.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

MethodFigures figures(const std::string& method, std::optional<double> settle_ms,
                      std::optional<double> lag_ms) {
    MethodFigures f;
    f.method = method;
    if (settle_ms) f.settle_ms = {*settle_ms, 0.0, 0.0, 0.0};
    f.ramp_delay_ms = lag_ms;
    return f;
}

Comparison of(std::vector<MethodFigures> methods) {
    Comparison comparison;
    comparison.methods = std::move(methods);
    return comparison;
}

}  // namespace

TEST_CASE("the verdict holds the first method that is no low-pass against the first low-pass") {
    const Comparison comparison =
        of({figures("none", 0.0, 0.0), figures("lowpass,cutoff=13Hz", 65.0, 12.2),
            figures("fixed,centers=25Hz", 130.0, 25.0), figures("switching", 1.0, 1.0)});
    CHECK(comparison.subject()->method == "fixed,centers=25Hz");
    CHECK(comparison.rival()->method == "lowpass,cutoff=13Hz");
    CHECK(verdict(comparison) ==
          "fixed,centers=25Hz settles 2.0 times slower than lowpass,cutoff=13Hz (130 against 65 ms to 0.5 "
          "%), lags 12.8 ms "
          "more (25.0 against 12.2 ms).");
}

TEST_CASE("a matched low-pass is the rival, and what is equal is said in its words") {
    Comparison comparison =
        of({figures("none", 0.0, 0.0), figures("fixed", 50.0, 10.0),
            figures("lowpass,cutoff=13Hz", 65.0, 12.2), figures("lowpass,cutoff=2Hz", 400.0, 80.0)});
    comparison.match = LowPassMatch{"fixed", "lowpass,cutoff=2Hz", "at an equal something", 1, {}, {}, {}};
    CHECK(comparison.rival()->method == "lowpass,cutoff=2Hz");
    CHECK(verdict(comparison) ==
          "fixed settles 8.0 times faster than lowpass,cutoff=2Hz (50 against 400 ms to 0.5 %), lags 70.0 ms "
          "less (10.0 "
          "against 80.0 ms), at an equal something.");
}

TEST_CASE("the verdict does not make much of little") {
    CHECK(verdict(of({figures("a", 100.0, 10.0), figures("b", 100.0, 10.0)})) ==
          "a settles as fast as b (100 against 100 ms to 0.5 %), lags as much (10.0 against 10.0 ms).");
    CHECK(verdict(of({figures("a", 100.0, 10.0), figures("b", 103.0, 10.02)})) ==
          "a settles about as fast as b (100 against 103 ms to 0.5 %), lags as much (10.0 against 10.0 ms).");
    CHECK(verdict(of({figures("a", 0.0, 0.0), figures("b", 103.0, 10.0)})) ==
          "a settles 103 ms earlier than b (0 against 103 ms to 0.5 %), lags 10.0 ms less (0.0 against 10.0 "
          "ms).");
}

TEST_CASE("the verdict says only what was measured") {
    CHECK(verdict(of({figures("none", 0.0, 0.0)})) == "Only the control ran; there is nothing to compare.");
    CHECK(verdict(of({figures("none", 0.0, 0.0), figures("a", std::nullopt, 38.04)})) == "a lags 38.0 ms.");
    CHECK(verdict(of({figures("a", std::nullopt, 10.0), figures("b", std::nullopt, 20.0)})) ==
          "a lags 10.0 ms less than b (10.0 against 20.0 ms).");
    Comparison comparison = of({figures("a", 100.0, std::nullopt), figures("b", 200.0, std::nullopt)});
    comparison.methods[0].ripple_rms_nm = 0.01;
    comparison.methods[1].ripple_rms_nm = 0.2;
    CHECK(verdict(comparison) ==
          "a settles 2.0 times faster than b (100 against 200 ms to 0.5 %), and has a remaining ripple of "
          "0.01 Nm "
          "rms against 0.2.");
}

TEST_CASE("the verdict counts a method's weakest line, and does not put a number on a complete null") {
    Comparison comparison = of({figures("a", std::nullopt, 1.0), figures("b", std::nullopt, 2.0)});
    comparison.methods[0].attenuation = {{1.0, 25.0, 200.0}, {2.0, 50.0, 200.0}};
    comparison.methods[1].attenuation = {{1.0, 25.0, 21.74}, {2.0, 50.0, 27.7}};
    CHECK_THAT(verdict(comparison),
               Catch::Contains("and attenuates its weakest line by more than 200 dB against 21.7 dB."));
    comparison.methods[0].attenuation = {{1.0, 25.0, std::nullopt}};
    CHECK_THAT(verdict(comparison), !Catch::Contains("dB"));
}

TEST_CASE("a long method is told by its name, or by what tells it from others of that name") {
    const std::string crossfade = "switching,table=a/long/path/to/table.json,transition=crossfade";
    const std::string keep = "switching,table=a/long/path/to/table.json,transition=keep";
    const std::string tracking = "tracking,q=2,gear-ratio=100,orders=1:2";
    CHECK(
        verdict(of({figures(crossfade, 100.0, {}), figures(keep, 50.0, {})})) ==
        "switching,transition=crossfade settles 2.0 times slower than switching,transition=keep (100 against "
        "50 ms to 0.5 %).");
    CHECK(verdict(of({figures(crossfade, 100.0, {}), figures(tracking, 50.0, {})})) ==
          "switching settles 2.0 times slower than tracking (100 against 50 ms to 0.5 %).");
}

TEST_CASE("where the truth is known, the verdict names the method that comes nearest to it") {
    Comparison comparison = of({figures("none", std::nullopt, 0.0), figures("a", std::nullopt, 20.0),
                                figures("b", std::nullopt, 10.0), figures("c", std::nullopt, 0.0)});
    const std::string before = "a lags 10.0 ms more than b (20.0 against 10.0 ms).";
    CHECK(verdict(comparison) == before);
    comparison.methods[0].error_rms_nm = 0.9;
    comparison.methods[1].error_rms_nm = 0.7834;
    comparison.methods[2].error_rms_nm = 0.7;
    comparison.methods[3].error_rms_nm = 0.0281;
    CHECK(verdict(comparison) ==
          before + " Smallest error against the true torque: c, 0.0281 Nm rms; a 0.783.");
    comparison.methods[0].error_rms_nm = 0.01;  // where filtering harms, the raw torque is the answer
    CHECK(verdict(comparison) ==
          before + " Smallest error against the true torque: none, 0.01 Nm rms; a 0.783.");
    comparison.methods[1].error_rms_nm = 0.001;
    CHECK(verdict(comparison) == before + " Smallest error against the true torque: a, 0.001 Nm rms.");
    // Of one method there is no nearest.
    comparison = of({figures("none", std::nullopt, 0.0), figures("a", std::nullopt, 20.0)});
    comparison.methods[0].error_rms_nm = 0.9;
    comparison.methods[1].error_rms_nm = 0.1;
    CHECK(verdict(comparison) == "a lags 20.0 ms.");
}
