// SPDX-License-Identifier: MIT
// Text to numbers and numbers to text, as the readers and writers of logs do it.
#include <memory>
#include <optional>
#include <stdexcept>

#include "benchmark.hpp"
#include "core/vectors/lanes.hpp"
#include "log/text/quick_rows.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch::bench {
namespace {

constexpr std::size_t rows = 100'000;
constexpr double numbers = 3.0 * rows;

enum class Digits { six, shortest };

void append(std::string& text, double value, Digits digits) {
    if (digits == Digits::six)
        append_fixed(text, value, 6);
    else
        append_shortest(text, value);
}

/// Thirds, so that "shortest" has all seventeen digits.
std::string text_of(const BenchLog& log, Digits digits) {
    const double share = digits == Digits::six ? 1.0 : 1.0 / 3.0;
    std::string text;
    for (std::size_t k = 0; k < log.torque_nm.size(); ++k) {
        append(text, log.time_s[k], digits);
        text += ',';
        append(text, share * log.velocity_deg_s[k], digits);
        text += ',';
        append(text, share * log.torque_nm[k], digits);
        text += '\n';
    }
    return text;
}

RowPlan three_columns() {
    RowPlan plan;
    plan.columns = 3;
    plan.wanted = {{0, time_slot}, {1, velocity_slot}, {2, torque_slot}};
    plan.factors = {1.0, 1.0, 1.0, 1.0};
    return plan;
}

Benchmark::Pass parse_rows(Digits digits, bool vectors) {
    auto block = std::make_shared<RowBlock>();
    block->bytes = text_of(BenchLog(rows), digits);
    std::optional<NarrowVectors> narrow;
    if (!vectors) narrow.emplace();
    auto quick = std::make_shared<QuickRows>(three_columns());
    return [block, quick] {
        block->drop_rows();
        if (quick->read(*block, 0, -1.0) != block->bytes.size())
            throw std::logic_error("not all rows were taken");
        keep(block->joints.front().torque_nm.back());
    };
}

Benchmark::Pass print_numbers(Digits digits) {
    auto log = std::make_shared<BenchLog>(static_cast<std::size_t>(numbers));
    auto text = std::make_shared<std::string>();
    return [log, text, digits] {
        text->clear();
        for (const double value : log->torque_nm) append(*text, value, digits);
        keep(static_cast<double>(text->size()));
    };
}

const Benchmark parse_six("numbers: read, 6 decimals", numbers, [] { return parse_rows(Digits::six, true); });
const Benchmark parse_shortest("numbers: read, 17 digits", numbers,
                               [] { return parse_rows(Digits::shortest, true); });
const Benchmark parse_six_scalar("numbers: read, 6 decimals, without vectors", numbers,
                                 [] { return parse_rows(Digits::six, false); });
const Benchmark print_six("numbers: print, 6 decimals", numbers, [] { return print_numbers(Digits::six); });
const Benchmark print_shortest("numbers: print, shortest", numbers,
                               [] { return print_numbers(Digits::shortest); });

}  // namespace
}  // namespace ripplenotch::bench
