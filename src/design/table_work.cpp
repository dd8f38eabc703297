// SPDX-License-Identifier: MIT
#include "ripplenotch/design/table_work.hpp"

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/design/transient.hpp"

namespace ripplenotch {
namespace {

// About half a second each. A response is taken at 257 speeds of a band, of each line through each notch.
constexpr double most_responses = 60000.0;  // lines times notches, over all bands
constexpr double most_steps = 2e8;          // samples of a step response times notches, over all bands

}  // namespace

void TableWork::add(const Band& band, double settle_band_percent) {
    const auto notches = static_cast<double>(band.notches.size());
    if (band.notches.size() > most_orders) {
        raise<UsageError>("{} notches in a band, expected at most {}; leave orders out", band.notches.size(),
                          most_orders);
    }
    if (++bands_ > most_bands) raise<UsageError>("more than {} bands; make them wider", most_bands);
    responses_ += notches * notches;
    if (responses_ > most_responses) {
        raise<UsageError>(
            "bands 1 to {} have too many notches to be measured ({} in this one); make the bands "
            "wider, or leave orders out",
            bands_, band.notches.size());
    }
    const Cascade cascade = band.cascade();
    steps_ += notches * static_cast<double>(samples_to_settle(cascade, settle_band_percent / 100.0));
    if (steps_ > most_steps) {
        raise<UsageError>(
            "bands 1 to {} settle too slowly to be measured together; make the bands wider, start "
            "them higher, or lower the Q or the sample rate",
            bands_);
    }
}

}  // namespace ripplenotch
