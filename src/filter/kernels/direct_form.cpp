// SPDX-License-Identifier: MIT
#include "filter/kernels/direct_form.hpp"

#include "core/lanes.hpp"
#include "filter/kernels/in_series.hpp"

namespace ripplenotch {
namespace {

/// Two sections in the lanes of one register. The second works two samples behind the first, so that its
/// input has been there for long enough not to be waited for.
void run_two(const Biquad& f, const Biquad& g, std::span<Past> past, std::span<const double> in,
             double origin, std::span<double> out) {
    const Two b0 = {f.b0, g.b0}, b1 = {f.b1, g.b1}, b2 = {f.b2, g.b2}, a1 = {f.a1, g.a1}, a2 = {f.a2, g.a2};
    Past first = past[0], second = past[1];
    double due = advance(f, first, in[0] - origin), next = advance(f, first, in[1] - origin);
    Two x1 = {first.x1, second.x1}, x2 = {first.x2, second.x2}, y1 = {first.y1, second.y1},
        y2 = {first.y2, second.y2};
    for (std::size_t k = 2; k < in.size(); ++k) {
        const Two x = {in[k] - origin, due};
        const Two y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
        x2 = x1;
        x1 = x;
        y2 = y1;
        y1 = y;
        out[k - 2] = origin + y[1];
        due = next;
        next = y[0];
    }
    past[0] = {x1[0], x2[0], y1[0], y2[0]};
    past[1] = {x1[1], x2[1], y1[1], y2[1]};
    out[in.size() - 2] = origin + advance(g, past[1], due);
    out[in.size() - 1] = origin + advance(g, past[1], next);
}

}  // namespace

void run_direct_form(std::span<const Biquad> sections, std::span<Past> past, std::span<const double> in,
                     double origin, std::span<double> out) {
    if (sections.size() == 2 && in.size() >= 2) {
        run_two(sections[0], sections[1], past, in, origin, out);
        return;
    }
    run_in_series(sections, past, in, origin, out,
                  [](const Biquad& f, Past& p, double x) { return advance(f, p, x); });
}

}  // namespace ripplenotch
