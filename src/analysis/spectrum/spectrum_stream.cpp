// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/spectrum_stream.hpp"

#include <vector>

#include "analysis/spectrum/welch.hpp"

namespace ripplenotch {

struct SpectrumStream::Work {
    Welch welch;
    std::vector<double> time_s = {}, torque_nm = {};  // of pieces that are not whole yet

    using Pass = std::size_t (Welch::*)(std::span<const double>, std::span<const double>);
    void feed(Pass pass, std::span<const double> more_s, std::span<const double> more_nm) {
        time_s.insert(time_s.end(), more_s.begin(), more_s.end());
        torque_nm.insert(torque_nm.end(), more_nm.begin(), more_nm.end());
        const auto done = static_cast<std::ptrdiff_t>((welch.*pass)(time_s, torque_nm));
        time_s.erase(time_s.begin(), time_s.begin() + done);
        torque_nm.erase(torque_nm.begin(), torque_nm.begin() + done);
    }
};

SpectrumStream::SpectrumStream(std::size_t length, Hertz rate)
    : work_(std::make_unique<Work>(Work{Welch(length, rate)})) {}
SpectrumStream::~SpectrumStream() = default;
SpectrumStream::SpectrumStream(SpectrumStream&&) noexcept = default;
SpectrumStream& SpectrumStream::operator=(SpectrumStream&&) noexcept = default;

void SpectrumStream::add(std::span<const double> time_s, std::span<const double> torque_nm) {
    work_->feed(&Welch::add, time_s, torque_nm);
}

bool SpectrumStream::settle(Hertz rate) {
    auto settled = work_->welch.at(rate);
    if (settled) work_->welch = std::move(*settled);
    return settled.has_value();
}

bool SpectrumStream::find_lines(double false_alarm) {
    work_->time_s.clear();
    work_->torque_nm.clear();
    return work_->welch.find_lines(false_alarm);
}

void SpectrumStream::measure(std::span<const double> time_s, std::span<const double> torque_nm) {
    work_->feed(&Welch::measure, time_s, torque_nm);
}

Spectrum SpectrumStream::spectrum() const { return work_->welch.spectrum(); }

}  // namespace ripplenotch
