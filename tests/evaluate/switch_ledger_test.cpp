// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/contender.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

// 100 samples at 1 kHz. The truth steps from 0 to 10 Nm at sample 10, so that 0.5, 1, 2 and 5 % of its range
// are 0.05, 0.1, 0.2 and 0.5 Nm.
struct Planted {
    std::vector<double> time_s, truth_nm, out_nm;
    std::vector<Switch> changes;
    Planted() {
        for (int k = 0; k < 100; ++k) {
            time_s.push_back(0.001 * k);
            truth_nm.push_back(k < 10 ? 0.0 : 10.0);
        }
        out_nm = truth_nm;
    }
    void add(std::size_t from, std::size_t end, double error_nm) {
        for (std::size_t k = from; k < end; ++k) out_nm[k] += error_nm;
    }
    [[nodiscard]] std::vector<SwitchEntry> ledger(std::size_t block, std::size_t gap_before = 0) const {
        SwitchLedger ledger(truth_nm);
        for (std::size_t at = 0; at < out_nm.size();) {
            if (at > 0 && at == gap_before) ledger.split();
            std::size_t end = std::min(at + block, out_nm.size());
            if (at < gap_before) end = std::min(end, gap_before);
            std::vector<Switch> so_far;  // a filter lists a change once it has put out that sample
            for (const Switch& change : changes) {
                if (change.sample < end) so_far.push_back(change);
            }
            ledger.add(std::span(time_s).subspan(at, end - at), std::span(out_nm).subspan(at, end - at),
                       so_far);
            at = end;
        }
        return ledger.entries();
    }
};

// Two changes: after the first the output is off by 1 Nm for 5 ms, by -2 at 5 ms, 0.3 to 10 ms, 0.08 to 20
// ms.
Planted two_changes() {
    Planted planted;
    planted.changes = {{20, 1, 2, 36.0, 1.25}, {60, 2, 3, 54.0, 0.08}};
    planted.add(19, 20, -0.25);
    planted.add(20, 25, 1.0);
    planted.add(25, 26, -2.0);
    planted.add(26, 30, 0.3);
    planted.add(30, 40, 0.08);
    planted.add(60, 100, 0.08);
    return planted;
}

double ms(const std::optional<Seconds>& time) { return 1e3 * time.value().value(); }

}  // namespace

TEST_CASE("an error planted after a change has the peak and the settling times that were planted") {
    const auto entries = two_changes().ledger(100);
    REQUIRE(entries.size() == 2);
    const SwitchEntry& first = entries[0];
    CHECK(first.change.from_band == 1);
    CHECK(first.time.value() == Approx(0.020));
    CHECK(1e3 * first.stretch.value() == Approx(39.0));  // samples 20 to 59
    CHECK(*first.error_before_nm == Approx(0.25));
    CHECK(*first.peak_error_nm == Approx(2.0));
    CHECK(ms(first.peak_after) == Approx(5.0));
    CHECK(ms(first.settle[0]) == Approx(20.0));  // 0.08 Nm is more than 0.5 % of 10 Nm ...
    CHECK(ms(first.settle[1]) == Approx(10.0));  // ... and less than 1 %
    CHECK(ms(first.settle[2]) == Approx(10.0));  // 0.3 Nm is more than 2 % ...
    CHECK(ms(first.settle[3]) == Approx(6.0));   // ... and less than 5 %
}

TEST_CASE(
    "an error that does not fall until the next change has not settled, one within from the start needs no "
    "time") {
    const SwitchEntry last = two_changes().ledger(100).back();
    CHECK(*last.error_before_nm == 0.0);
    CHECK(*last.peak_error_nm == Approx(0.08));
    CHECK_FALSE(last.settle[0].has_value());
    CHECK(ms(last.settle[1]) == 0.0);
    CHECK(ms(last.settle[3]) == 0.0);
    CHECK(1e3 * last.stretch.value() == Approx(39.0));  // to the end of the log
}

TEST_CASE("what leaves its band again has settled only after that") {
    Planted planted = two_changes();
    planted.add(45, 47, 0.7);
    const SwitchEntry first = planted.ledger(100).front();
    for (const auto& settle : first.settle) CHECK(ms(settle) == Approx(27.0));  // 47 - 20
    CHECK(*first.peak_error_nm == Approx(2.0));
}

TEST_CASE("the switching ledger does not depend on how the log is cut into blocks") {
    const auto whole = two_changes().ledger(100);
    for (const std::size_t block : {1U, 7U, 20U, 33U}) {
        const auto cut = two_changes().ledger(block);
        REQUIRE(cut.size() == whole.size());
        for (std::size_t i = 0; i < whole.size(); ++i) {
            CHECK(cut[i].peak_error_nm == whole[i].peak_error_nm);
            CHECK(cut[i].error_before_nm == whole[i].error_before_nm);
            CHECK(cut[i].settle == whole[i].settle);
            CHECK(cut[i].stretch == whole[i].stretch);
        }
    }
}

TEST_CASE("a gap ends a change's stretch, and what was before it is not before the next change") {
    Planted planted = two_changes();
    planted.add(50, 60, 5.0);  // behind the gap: nobody's
    const auto entries = planted.ledger(100, 50);
    CHECK(*entries[0].peak_error_nm == Approx(2.0));
    CHECK(ms(entries[0].settle[0]) == Approx(20.0));
    CHECK(1e3 * entries[0].stretch.value() == Approx(29.0));
    const auto right_after = planted.ledger(100, 60);
    CHECK_FALSE(right_after[1].error_before_nm.has_value());
}

TEST_CASE("without a truth a change has a time and a jump, and no errors") {
    Planted planted = two_changes();
    planted.truth_nm.clear();
    const auto entries = planted.ledger(100);
    REQUIRE(entries.size() == 2);
    CHECK(entries[0].change.jump_nm == 1.25);
    CHECK(1e3 * entries[0].stretch.value() == Approx(39.0));
    CHECK_FALSE(entries[0].peak_error_nm.has_value());
    CHECK_FALSE(entries[0].settle[3].has_value());
}
