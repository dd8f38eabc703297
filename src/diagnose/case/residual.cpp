// SPDX-License-Identifier: MIT
#include "diagnose/case/residual.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {

double rms_of(const std::vector<double>& values, const std::vector<unsigned char>& use) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (use[k] == 0) continue;
        sum += values[k] * values[k];
        count += 1.0;
    }
    return std::sqrt(sum / std::max(count, 1.0));
}

std::vector<double> residual_nm(const Case& looked_at, const Model& stated) {
    std::vector<double> left = predict_nm(stated, looked_at.motion);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = looked_at.torque_nm[k] - left[k];
    return left;
}

double left_rms(const Case& looked_at, const Model& stated) {
    return rms_of(residual_nm(looked_at, stated), looked_at.use);
}

}  // namespace ripplenotch
