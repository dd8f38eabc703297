// SPDX-License-Identifier: MIT
#include "ripplenotch/design/candidate_table.hpp"

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {

// Notches of Q 0.25 at `center` Hz and 1 kHz.
Band band_of(std::size_t notches, double center) {
    const NotchSpec spec{Hertz(center), 0.25, infinite_depth_db, WidthRule::analog};
    Band band;
    band.notches.assign(notches, {Order(1.0), spec, design_notch(spec, Hertz(1000.0))});
    return band;
}

// How many of such bands are taken.
std::size_t taken(std::size_t notches, double center, std::string& refusal) {
    const Band band = band_of(notches, center);
    TableWork work;
    for (std::size_t count = 0;; ++count) {
        try {
            work.add(band, 0.5);
        } catch (const UsageError& error) {
            refusal = error.what();
            return count;
        }
    }
}

}  // namespace

TEST_CASE("the work on a table is bounded in bands, in notches and in samples", "[design]") {
    std::string refusal;
    CHECK(taken(1, 100.0, refusal) == most_bands);
    CHECK_THAT(refusal, Contains("more than 10000 bands"));
    CHECK(taken(most_orders + 1, 100.0, refusal) == 0);
    CHECK_THAT(refusal, Contains("65 notches in a band, expected at most 64"));
    CHECK(taken(60, 100.0, refusal) == 60000 / (60 * 60));
    CHECK_THAT(refusal, Contains("too many notches"));
    // At 0.01 Hz the slower pole takes 59 s, 59,000 samples, and some 31 of these are counted.
    const std::size_t slow = taken(2, 0.01, refusal);
    CHECK(slow > 2);
    CHECK(slow < 200);
    CHECK_THAT(refusal, Contains("settle too slowly"));
}

TEST_CASE("a table of ten thousand bands can be designed and read", "[design]") {
    TableWork work;
    const Band band = band_of(2, 12.5);  // a low centre, in every band
    for (std::size_t i = 0; i < most_bands; ++i) work.add(band, 0.5);
    CHECK_THROWS_AS(work.add(band, 0.5), UsageError);
}
