// SPDX-License-Identifier: MIT
// usage: bench_make_log 6|shortest|npy JOINTS ROWS > log
// A log of any length, as long as it takes to write it: 6 decimals; all digits; or an array of float64
// without names.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch::bench {
namespace {

enum class Format { six, shortest, npy };

struct Sample {
    double time_s, velocity_deg_s, torque_nm;
};

/// Samples of a joint, 2000 a second: speed through all bands of a table up to 166 deg/s, ripple at orders 1
/// and 2 of a gear of 40, noise from a linear congruential generator. Joints differ in where their motion
/// begins.
class BenchSignal {
  public:
    explicit BenchSignal(std::size_t joint) : joint_(static_cast<double>(joint)), seed_(joint + 1) {}
    Sample next() {
        const double t = static_cast<double>(count_++) / 2000.0, at = t + 10.0 * joint_;
        const double speed = 166.0 * std::sin(0.314 * at) * std::sin(0.17 * at + 1.0);
        motor_ += 40.0 * speed * std::numbers::pi / 180.0 / 2000.0;
        seed_ = seed_ * 16807 % 2147483647;
        const double noise = static_cast<double>(seed_) / 2147483647.0 - 0.5;
        return {t, speed,
                speed / 52.0 + 0.8 * std::sin(motor_) + 0.35 * std::sin(2.0 * motor_ + 1.0) + 0.2 * noise};
    }

  private:
    double joint_, motor_ = 0.0;
    std::uint64_t seed_, count_ = 0;
};

std::string head(Format format, std::size_t joints, std::size_t rows) {
    if (format == Format::npy) {
        std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}), }}",
                                         rows, 1 + 2 * joints);
        header.resize((header.size() + 11 + 63) / 64 * 64 - 11, ' ');
        const auto size = static_cast<unsigned>(header.size() + 1);
        std::string bytes("\x93NUMPY\x01\x00", 8);
        bytes += {static_cast<char>(size % 256), static_cast<char>(size / 256)};
        bytes += header;
        bytes += '\n';
        return bytes;
    }
    std::string names = "time_s";
    for (std::size_t j = 1; j <= joints; ++j) {
        std::string joint;
        if (joints > 1) joint = fmt::format("j{}_", j);
        names += fmt::format(",{}velocity_deg_s,{}torque_nm", joint, joint);
    }
    names += '\n';
    return names;
}

/// Thirds in the long format, so that most numbers have all their seventeen digits.
void append(std::string& text, double value, Format format) {
    if (format == Format::npy)
        text.append(reinterpret_cast<const char*>(&value), sizeof value);
    else if (format == Format::six)
        append_fixed(text, value, 6);
    else
        append_shortest(text, value / 3.0);
}

void append_row(std::string& text, std::vector<BenchSignal>& joints, Format format) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const Sample sample = joints[j].next();
        if (j == 0) {
            if (format == Format::six)
                append_fixed(text, sample.time_s, 4);
            else
                append(text, format == Format::npy ? sample.time_s : 3.0 * sample.time_s, format);
        }
        for (const double value : {sample.velocity_deg_s, sample.torque_nm}) {
            if (format != Format::npy) text += ',';
            append(text, value, format);
        }
    }
    if (format != Format::npy) text += '\n';
}

int make(Format format, std::size_t joint_count, std::size_t rows) {
    std::vector<BenchSignal> joints;
    for (std::size_t j = 0; j < joint_count; ++j) joints.emplace_back(j);
    std::string text = head(format, joint_count, rows);
    for (std::size_t row = 0; row < rows; ++row) {
        append_row(text, joints, format);
        if (text.size() < 1'000'000 && row + 1 < rows) continue;
        if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) return EXIT_FAILURE;
        text.clear();
    }
    return std::fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace ripplenotch::bench

int main(int count, char** arguments) {
    using namespace ripplenotch::bench;
    if (count != 4) {
        fmt::print(stderr, "usage: bench_make_log 6|shortest|npy JOINTS ROWS > log\n");
        return 2;
    }
    const std::string_view format = arguments[1];
    return make(format == "6"     ? Format::six
                : format == "npy" ? Format::npy
                                  : Format::shortest,
                std::strtoul(arguments[2], nullptr, 10), std::strtoul(arguments[3], nullptr, 10));
}
