// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "core/text/lower_case.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

namespace {

struct Kind {
    std::string_view ending, name;
};
// What commands write, and what people take for granted that a name like that makes them write.
constexpr std::array kinds = {
    Kind{".txt", "text"},         Kind{".json", "JSON"},      Kind{".csv", "CSV"},
    Kind{".tsv", "TSV"},          Kind{".npy", "NumPy"},      Kind{".html", "HTML"},
    Kind{".htm", "HTML"},         Kind{".svg", "a picture"},  Kind{".png", "a picture"},
    Kind{".pdf", "a picture"},    Kind{".jpg", "a picture"},  Kind{".eps", "a picture"},
    Kind{".h", "a C header"},     Kind{".hpp", "a C header"}, Kind{".c", "C"},
    Kind{".m", "a script"},       Kind{".py", "a script"},    Kind{".yaml", "YAML"},
    Kind{".yml", "YAML"},         Kind{".xml", "XML"},        Kind{".param", "parameters"},
    Kind{".npz", "NumPy (.npz)"}, Kind{".mat", "MATLAB"},     Kind{".h5", "HDF5"},
    Kind{".hdf5", "HDF5"},        Kind{".xlsx", "Excel"},     Kind{".xls", "Excel"},
    Kind{".parquet", "Parquet"},  Kind{".mcap", "MCAP"},      Kind{".bag", "a bag"},
    Kind{".gz", "compressed"},    Kind{".zip", "compressed"}, Kind{".zst", "compressed"},
};

std::string ending_of(std::string_view path) {
    const std::string_view name =
        path.substr(path.rfind('/') == std::string_view::npos ? 0 : path.rfind('/') + 1);
    const std::size_t dot = name.rfind('.');
    if (dot == std::string_view::npos || dot == 0) return "";
    return lower_case(name.substr(dot));
}

bool fits(std::string_view ending, std::string_view endings) {
    for (std::size_t at = endings.find(ending); at != std::string_view::npos;
         at = endings.find(ending, at + 1)) {
        const std::size_t end = at + ending.size();
        if (end == endings.size() || endings[end] == ' ') return true;
    }
    return false;
}

// ".csv .npy .json" as ".csv, .npy or .json"
std::string listed(std::string_view endings) {
    std::string list(endings);
    const std::size_t last = list.rfind(' ');
    if (last == std::string::npos) return list;
    list.replace(last, 1, " or ");
    for (std::size_t at = list.find(' '); at < last; at = list.find(' ', at + 2)) list.insert(at, 1, ',');
    return list;
}

}  // namespace

void check_output_name(std::string_view path, std::string_view what, std::string_view endings,
                       std::string_view option) {
    const std::string ending = ending_of(path);
    const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&](const Kind& one) { return one.ending == ending; });
    if (kind == kinds.end() || fits(ending, endings)) return;
    raise<UsageError>("{} {}: {} is not written as {}; name it {}", option, path, what, kind->name,
                      listed(endings));
}

}  // namespace ripplenotch
