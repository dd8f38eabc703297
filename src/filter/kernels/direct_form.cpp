// SPDX-License-Identifier: MIT
#include "filter/kernels/direct_form.hpp"

#include "core/vectors/lanes.hpp"
#include "filter/kernels/in_series.hpp"

namespace ripplenotch {
namespace {

/// How many samples the second of two sections works behind the first: long enough for its input to have been
/// written and to be read again without being waited for.
constexpr std::size_t behind = 6;

/// Two sections in the lanes of one register. What the first makes of a sample waits in `out` for the second.
void run_two(const Biquad& f, const Biquad& g, std::span<Past> past, std::span<const double> in,
             double origin, std::span<double> out) {
    for (std::size_t k = 0; k < behind; ++k) out[k] = advance(f, past[0], in[k] - origin);
    const Two b0 = {f.b0, g.b0}, b1 = {f.b1, g.b1}, b2 = {f.b2, g.b2}, a1 = {f.a1, g.a1}, a2 = {f.a2, g.a2};
    // x - 0 and -0 + x change no number, not even the sign of a zero.
    const Two less = {origin, 0.0}, plus = {-0.0, origin};
    Two x1 = {past[0].x1, past[1].x1}, x2 = {past[0].x2, past[1].x2}, y1 = {past[0].y1, past[1].y1},
        y2 = {past[0].y2, past[1].y2};
    for (std::size_t k = behind; k < in.size(); ++k) {
        const Two x = Two{in[k], out[k - behind]} - less;
        const Two y = b0 * x + b1 * x1 + b2 * x2 - a2 * y2 - a1 * y1;
        x2 = x1;
        x1 = x;
        y2 = y1;
        y1 = y;
        const Two result = plus + y;
        out[k] = result[0];
        out[k - behind] = result[1];
    }
    past[0] = {x1[0], x2[0], y1[0], y2[0]};
    past[1] = {x1[1], x2[1], y1[1], y2[1]};
    for (std::size_t k = in.size() - behind; k < in.size(); ++k)
        out[k] = origin + advance(g, past[1], out[k]);
}

}  // namespace

void run_direct_form(std::span<const Biquad> sections, std::span<Past> past, std::span<const double> in,
                     double origin, std::span<double> out) {
    if (sections.size() == 2 && in.size() >= behind) {
        run_two(sections[0], sections[1], past, in, origin, out);
        return;
    }
    run_in_series(sections, past, in, origin, out,
                  [](const Biquad& f, Past& p, double x) { return advance(f, p, x); });
}

}  // namespace ripplenotch
