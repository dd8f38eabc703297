// SPDX-License-Identifier: MIT
#include "fuzz/reading.hpp"

#include <cmath>
#include <cstring>
#include <exception>
#include <memory>

#include "fuzz/fuzz.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch::fuzz {
namespace {

void add(std::string& into, const std::vector<double>& values) {
    const std::size_t before = into.size();
    into.resize(before + values.size() * sizeof(double));
    if (!values.empty()) std::memcpy(into.data() + before, values.data(), values.size() * sizeof(double));
}

void add(std::string& into, const std::vector<std::uint32_t>& places, std::size_t shift) {
    for (const std::uint32_t place : places) into += std::to_string(place + shift) + " ";
}

// A factor of a unit is at most 1e4 or so.
void check(const std::vector<double>& values) {
    for (const double value : values)
        if (std::isinf(value) || std::abs(value) > 1e6 * largest_reading)
            fail("a reading", std::to_string(value), "");
}

}  // namespace

std::string reading(std::string_view bytes, const ReadOptions& options, std::size_t piece) {
    std::string times, torques, motion, places;
    const std::string answer = answer_of([&] {
        const auto reader = open_log(
            std::make_unique<ByteSource>("log", std::make_shared<const std::string>(bytes), piece), options);
        RowBlock block;
        std::size_t before = 0;
        // Not next(): rows before one that is wrong count, however the bytes arrived.
        while (reader->fetch(block)) {
            reader->parse(block);
            reader->accept(block);
            add(times, block.time_s);
            add(places, block.row_end, before);
            for (const JointRows& joint : block.joints) {
                check(joint.torque_nm);
                add(torques, joint.torque_nm);
                add(motion, joint.velocity_deg_s);
                add(motion, joint.position_deg);
                add(places, joint.torque_begin, before);
                add(places, joint.torque_end, before);
            }
            before += block.bytes.size();
            if (block.failure) std::rethrow_exception(block.failure);
        }
    });
    return times + "|" + torques + "|" + motion + "|" + (piece == std::string::npos ? places : "") + "|" +
           answer;
}

ReadOptions options_of(unsigned choice) {
    ReadOptions options;
    options.needs_torque = choice % 2 == 0;
    switch (choice / 2) {
        case 1:
            options.hold_bad_values = true;
            break;
        case 2:
            options.sample_rate = Hertz(1000.0);
            break;
        case 3:
            options.columns = {"time", "velocity", "torque"};
            break;
        case 4:
            options.header = false;
            break;
        case 5:
            options.skip_lines = 2;
            break;
        default:
            break;
    }
    return options;
}

}  // namespace ripplenotch::fuzz
