// SPDX-License-Identifier: MIT
#include "filter/kernels/block_form.hpp"

namespace ripplenotch {
namespace {

// What eight steps make of a memory and an input at one of the samples (or none: `at` beyond them).
struct Course {
    BlockForm::Memory memory{};
    std::array<double, BlockForm::samples> outputs{};

    void run(std::span<const Biquad> sections, std::size_t at) {
        for (std::size_t k = 0; k < BlockForm::samples; ++k) {
            double signal = k == at ? 1.0 : 0.0;
            for (std::size_t i = 0; i < sections.size(); ++i) {
                const Biquad& f = sections[i];
                double& s1 = memory[2 * i];
                double& s2 = memory[2 * i + 1];
                const double y = f.b0 * signal + s1;
                s1 = f.b1 * signal + s2 - f.a1 * y;
                s2 = f.b2 * signal - f.a2 * y;
                signal = y;
            }
            outputs[k] = signal;
        }
    }
};

}  // namespace

BlockForm::BlockForm(std::span<const Biquad> sections) {
    for (std::size_t j = 0; j < samples; ++j) {
        Course course;
        course.run(sections, j);
        feed[j] = course.outputs;
        drive[j] = course.memory;
    }
    for (std::size_t k = 0; k < 2 * sections.size(); ++k) {
        Course course;
        course.memory[k] = 1.0;
        course.run(sections, samples);
        recall[k] = course.outputs;
        turn[k] = course.memory;
    }
}

}  // namespace ripplenotch
