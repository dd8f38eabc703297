// SPDX-License-Identifier: MIT
// Descriptions of robots: URDF, MuJoCo, tables of Denavit and Hartenberg, and letters.
#include "fuzz/fuzz.hpp"
#include "ripplenotch/arm/chain.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes input(data, size);
    const unsigned reader = input.choice(6);
    const std::string_view text = input.rest();
    static_cast<void>(answer_of([&] {
        switch (reader) {
            case 0:
                return static_cast<void>(chain_of_urdf("arm", text, std::nullopt));
            case 1:
                return static_cast<void>(chain_of_mjcf("arm", text, std::nullopt));
            case 2:
                return static_cast<void>(chain_of_dh("arm", text));
            case 3:
                return static_cast<void>(chain_of_mdh("arm", text));
            case 4:
                return static_cast<void>(chain_of_urdf("arm", text, "tool"));
            default:
                return static_cast<void>(chain_of_axes(text));
        }
    }));
    return 0;
}
