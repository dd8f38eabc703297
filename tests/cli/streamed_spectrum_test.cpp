// SPDX-License-Identifier: MIT
// A log that goes by says what it says in memory, bit for bit: clock, warnings, speed and spectrum.
#include "cli/spectrum/spectrum.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "log/log_support.hpp"
#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;

namespace {

constexpr double tau = 2.0 * std::numbers::pi;

struct Row {
    double time_s, velocity, torque_nm;
    std::optional<double> position;
};

/// Changes a row of an even log at 1 kHz that swings by 200 deg; empty: the row as it is.
struct Case {
    std::string name;
    std::function<void(std::size_t, Row&)> change = {};
    std::size_t rows = 20'000;
    double segment_s = 0.512;
    std::string header = "time_s,velocity_deg_s,torque_nm,position_deg";
    int time_decimals = 6, torque_decimals = 6;
    ReadOptions options = {};
};

std::string text_of(const Case& one) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> noise;
    const bool position = one.header.find("position") != std::string::npos;
    std::string text = one.header + "\n";
    for (std::size_t i = 0; i < one.rows; ++i) {
        const double t = static_cast<double>(i) / 1000.0, w = 0.9;
        Row row{t, 100.0 * w * std::cos(w * t) + 0.1 * noise(random),
                0.8 * std::cos(tau * 61.3 * t) + 0.3 * std::cos(tau * 202.0 * t) + 0.1 * noise(random),
                100.0 * std::sin(w * t) + 0.001 * noise(random)};
        if (one.change) one.change(i, row);
        // By the library, which is optimised: most of this test was its own numbers.
        append_fixed(text, row.time_s, one.time_decimals);
        append_fixed(text += ',', row.velocity, 6);
        append_fixed(text += ',', row.torque_nm, one.torque_decimals);
        if (position) append_fixed(text += ',', *row.position, 6);
        text += '\n';
    }
    return text;
}

void steady(std::size_t i, Row& row) {
    row.velocity = 90.0;
    row.position = 0.09 * static_cast<double>(i);
}

std::vector<Case> cases() {
    const std::string plain = "time_s,velocity_deg_s,torque_nm", bare = "time,velocity,torque,position";
    const auto wrapped = [](double turn) {
        return [turn](std::size_t i, Row& row) {
            const double angle = 0.001 * turn * static_cast<double>(i);
            row.velocity = turn;
            row.position = angle - turn * std::floor(angle / turn);
        };
    };
    ReadOptions stated;
    stated.sample_rate = Hertz(700.0);
    return {
        {.name = "moving"},
        {.name = "steady", .change = steady},
        {.name = "one piece", .rows = 3000, .segment_s = 3.0},
        {.name = "longer pieces than the log", .rows = 3000, .segment_s = 30.0},
        {.name = "odd pieces", .segment_s = 0.333},
        {.name = "short", .rows = 70, .segment_s = 0.064},
        {.name = "no position", .header = plain},
        {.name = "gaps",
         .change = [](std::size_t i, Row& row) { row.time_s += i < 5000     ? 0.0
                                                               : i < 15'000 ? 1.0
                                                                            : 7.5; }},
        {.name = "many gaps",
         .change = [](std::size_t i, Row& row) { row.time_s += 0.1 * static_cast<double>(i / 100); }},
        {.name = "a step of nearly a gap",
         .change = [](std::size_t i, Row& row) { row.time_s += i < 9000 ? 0.0 : 0.0091; }},
        {.name = "jitter",
         .change = [](std::size_t i,
                      Row& row) { row.time_s += 2e-4 * std::sin(static_cast<double>(i * i)); }},
        {.name = "much jitter",
         .change = [](std::size_t i,
                      Row& row) { row.time_s += 4.9e-4 * std::sin(static_cast<double>(i * i)); }},
        {.name = "one late sample",
         .change = [](std::size_t i, Row& row) { row.time_s += i == 12'345 ? 3e-4 : 0.0; }},
        {.name = "a clock in tenths of a second per cent",
         .change = [](std::size_t, Row& row) { row.time_s *= 1.00003; }},
        {.name = "repeated times",
         .change = [](std::size_t, Row& row) { row.time_s *= 0.4; },
         .time_decimals = 3},
        {.name = "mostly repeated times",
         .change = [](std::size_t, Row& row) { row.time_s *= 0.25; },
         .time_decimals = 3},
        {.name = "slower from some row on",
         .change =
             [](std::size_t i, Row& row) {
                 if (i > 4000) row.time_s = 4.0 + 0.004 * static_cast<double>(i - 4000);
             }},
        {.name = "coarse torque at a commanded speed",
         .change = steady,
         .header = plain,
         .torque_decimals = 1},
        {.name = "held, at a commanded speed",
         .change =
             [](std::size_t i, Row& row) {
                 steady(i, row);
                 if (i % 50 < 2) row.torque_nm = 0.25;
             },
         .header = plain},
        {.name = "wraps at a turn", .change = wrapped(360.0)},
        {.name = "wraps at 2 pi", .change = wrapped(tau)},
        {.name = "wraps at a turn mistaken for radians",
         .change = wrapped(360.0),
         .header = "time_s,velocity_deg_s,torque_nm,position_rad"},
        {.name = "speed in rad/s, position in deg",
         .change = [](std::size_t, Row& row) { row.velocity /= 57.29578; },
         .header = bare},
        {.name = "all in radians",
         .change =
             [](std::size_t, Row& row) {
                 row.velocity /= 57.29578;
                 row.position = *row.position / 57.29578;
             },
         .header = bare},
        {.name = "at rest",
         .change =
             [](std::size_t, Row& row) {
                 row.velocity = 0.0;
                 row.position = 0.0;
             }},
        {.name = "a stated rate", .options = stated},
    };
}

/// Numbers that are equal to the last bit; NaN to NaN.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
bool same(const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) { return same(x, y); });
}

void check_same(const Spectrum& streamed, const Spectrum& whole) {
    CHECK(same(streamed.hz, whole.hz));
    CHECK(same(streamed.amplitude_nm, whole.amplitude_nm));
    CHECK(same(streamed.psd_nm2_hz, whole.psd_nm2_hz));
    CHECK(same(streamed.floor_nm, whole.floor_nm));
    CHECK(streamed.pieces == whole.pieces);
    REQUIRE(streamed.peaks.size() == whole.peaks.size());
    for (std::size_t k = 0; k < whole.peaks.size(); ++k) {
        CHECK(same(streamed.peaks[k].hz, whole.peaks[k].hz));
        CHECK(same(streamed.peaks[k].amplitude_nm, whole.peaks[k].amplitude_nm));
        CHECK(same(streamed.peaks[k].phase_deg, whole.peaks[k].phase_deg));
        CHECK(same(streamed.peaks[k].hz_stderr, whole.peaks[k].hz_stderr));
    }
}

void check_same(const std::string& path, const ReadOptions& options, double segment_s) {
    const Log whole = read_log(path, options);
    const SpectrumOptions spectrum{.segment = Seconds(segment_s)};
    LogPasses log(path, options);
    int told = 0;
    const LogSpectrum streamed = streamed_spectrum(log, spectrum, [&] {
        ++told;
        CHECK(log.log().layout.warnings == whole.layout.warnings);
        CHECK(log.log().layout.options == whole.layout.options);
        CHECK(log.log().recording.warnings == whole.recording.warnings);
    });
    CHECK(told == 1);
    CHECK(log.facts().rows == whole.trace.size());
    CHECK(same(log.log().trace.sample_rate.value(), whole.trace.sample_rate.value()));
    const Stretch stretch = whole_log(whole.trace.view());
    CHECK(streamed.stretch.count == stretch.count);
    CHECK(same(streamed.stretch.duration.value(), stretch.duration.value()));
    CHECK(same(streamed.stretch.speed.value(), stretch.speed.value()));
    CHECK(same(streamed.stretch.speed_error_deg_s, stretch.speed_error_deg_s));
    CHECK(same(streamed.stretch.turning_deg_s, stretch.turning_deg_s));
    CHECK(same(streamed.stretch.turning_spread_deg_s, stretch.turning_spread_deg_s));
    check_same(streamed.spectrum, torque_spectrum(whole.trace.view(), spectrum));
}

}  // namespace

TEST_CASE("a streamed spectrum is that of the log in memory, to the last bit and the last warning") {
    for (const Case& one : cases()) {
        DYNAMIC_SECTION(one.name) {
            const test::TemporaryPath path;
            write_all(path.string(), text_of(one), ByteSink::Overwrite::yes);
            check_same(path.string(), one.options, one.segment_s);
        }
    }
}

TEST_CASE("the cases of streaming are what their names say") {
    const auto warnings_of = [](const std::string& name) {
        for (const Case& one : cases()) {
            if (one.name != name) continue;
            const Log log = test::read_text(text_of(one), one.options);
            std::string all;
            for (const auto& list : {log.layout.warnings, log.recording.warnings})
                for (const LogWarning& warning : list) all += warning.text + "\n";
            return all;
        }
        return std::string("no such case");
    };
    CHECK(warnings_of("moving").empty());
    CHECK_THAT(warnings_of("gaps"), Catch::Contains("2 gaps in the time"));
    CHECK_THAT(warnings_of("mostly repeated times"), Catch::Contains("repeat the time"));
    CHECK(warnings_of("coarse torque at a commanded speed").empty());
    CHECK_THAT(warnings_of("held, at a commanded speed"), Catch::Contains("repeat the previous sample"));
    CHECK_THAT(warnings_of("wraps at a turn"), Catch::Contains("starts again at 360 deg"));
    CHECK_THAT(warnings_of("wraps at 2 pi"), Catch::Contains("starts again at 6.283 deg"));
    for (const Case& one : cases()) {
        if (one.name != "speed in rad/s, position in deg") continue;
        CHECK_THAT(test::read_text(text_of(one), one.options).layout.options,
                   Catch::Contains("velocity=rad/s") && Catch::Contains("position=deg"));
    }
    CHECK_THAT(warnings_of("all in radians"), Catch::Contains("as rad/s"));
}

TEST_CASE("a streamed log over no time, and too short pieces, are refused as in memory") {
    const test::TemporaryPath path;
    const Case standing{.name = "", .change = [](std::size_t, Row& row) { row.time_s = 1.0; }, .rows = 300};
    write_all(path.string(), text_of(standing), ByteSink::Overwrite::yes);
    std::string in_memory, streamed;
    try {
        static_cast<void>(read_log(path.string(), {}));
    } catch (const DataError& error) {
        in_memory = error.what();
    }
    try {
        LogPasses(path.string(), {}).first();
    } catch (const DataError& error) {
        streamed = error.what();
    }
    CHECK_THAT(in_memory, Catch::Contains("time does not advance"));
    CHECK(streamed == in_memory);

    const test::TemporaryPath good;
    write_all(good.string(), text_of({.name = "", .rows = 300}), ByteSink::Overwrite::yes);
    LogPasses log(good.string(), {});
    bool told = false;
    CHECK_THROWS_WITH(streamed_spectrum(log, {.segment = Seconds(0.05)}, [&] { told = true; }),
                      Catch::Contains("at least 64 samples, there are 50; use a longer --segment"));
    CHECK(told);
}

TEST_CASE("real: a streamed spectrum is that of the log in memory") {
    const std::string folder = logs_folder();
    for (const std::string name : {"gpl3/panda_gaz_j1.csv", "neura_lara8_j3.csv"}) {
        if (!std::filesystem::exists(folder + "/" + name)) {
            test::skipped(name + " is not in the folder of real logs");
            continue;
        }
        check_same(folder + "/" + name, {}, 1.0);
    }
}
