// SPDX-License-Identifier: MIT
// The Python module as C++ sees it: logs as arrays, and commands by their words. ripplenotch/__init__.py
// makes functions of it.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "cli/options/options.hpp"
#include "cli/run.hpp"
#include "cli/talk.hpp"
#include "core/files/byte_sink.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/log/log.hpp"

namespace py = pybind11;

namespace ripplenotch {
namespace {

/// The tool as a guest in another process: what it would print is kept, and what it knows of files is
/// forgotten behind it, since they may change between two calls. One call at a time, because the tool has one
/// standard output and one list of inputs.
class Guest {
  public:
    Guest() : turn_(mutex()) {
        capture_output(&output);
        capture_talk(&talk);
    }
    ~Guest() {
        watch_inputs(false);
        capture_talk(nullptr);
        capture_output(nullptr);
    }
    Guest(const Guest&) = delete;
    Guest& operator=(const Guest&) = delete;

    std::string output, talk;

  private:
    static std::mutex& mutex() {
        static std::mutex one;
        return one;
    }
    std::lock_guard<std::mutex> turn_;
};

/// How a call ended: the exit code of the tool, the message of an error, standard output and standard error.
struct Ended {
    ExitCode code = ExitCode::done;
    std::string error, output, talk;
};

/// `work` gives the code, or throws what commands throw. Other threads of Python run meanwhile.
template <class Work>
Ended ended(const Work& work) {
    const py::gil_scoped_release release;
    Guest guest;
    Ended end;
    try {
        end.code = work();
    } catch (const Error& error) {
        end.code = error.code();
        end.error = error.what();
    } catch (const std::bad_alloc&) {
        end.code = ExitCode::memory;
    }
    end.output = std::move(guest.output);
    end.talk = std::move(guest.talk);
    return end;
}

py::tuple run_words(const CommandWords& words) {
    const Ended end = ended([&] { return run_within(words); });
    return py::make_tuple(static_cast<int>(end.code), end.error, py::bytes(end.output), end.talk);
}

/// An array that owns the values; read-only, since it represents the log.
py::array_t<double> array_of(std::vector<double>&& values) {
    auto* const kept = new std::vector<double>(std::move(values));
    const py::capsule owner(kept, [](void* gone) { delete static_cast<std::vector<double>*>(gone); });
    py::array_t<double> array(static_cast<py::ssize_t>(kept->size()), kept->data(), owner);
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

py::object log_of(Log&& log) {
    py::dict fields;
    fields["joint"] = log.trace.joint;
    fields["joints"] = log.layout.joints;
    fields["format"] = log.layout.format;
    fields["torque_unit"] = log.recording.torque_unit;
    fields["sample_rate_hz"] = log.recording.clock.nominal_rate.value();
    fields["options"] = log.layout.options;
    std::vector<std::string> warnings;
    for (const auto* some : {&log.layout.warnings, &log.recording.warnings})
        for (const LogWarning& warning : *some) warnings.push_back(warning.text);
    fields["warnings"] = warnings;
    fields["time_s"] = array_of(std::move(log.trace.time_s));
    fields["velocity_deg_s"] = array_of(std::move(log.trace.velocity_deg_s));
    fields["torque_nm"] = array_of(std::move(log.trace.torque_nm));
    fields["position_deg"] =
        log.trace.position_deg.empty() ? py::object(py::none()) : array_of(std::move(log.trace.position_deg));
    return fields;
}

py::tuple read_words(const std::string& path, const CommandWords& words) {
    Log log;
    const Ended end = ended([&] {
        ReadOptions options;
        GearOptions gear;
        parse_options("info", words, [&](Options& declared) {
            attach_gear(declared, gear, {.orders = "", .joint_file = ""});
            attach_log(declared, options);
        });
        options.gear_ratio = gear.ratio;
        log = read_log(path, options);
        return ExitCode::done;
    });
    return py::make_tuple(static_cast<int>(end.code), end.error,
                          end.code == ExitCode::done ? log_of(std::move(log)) : py::none());
}

}  // namespace
}  // namespace ripplenotch

PYBIND11_MODULE(_ripplenotch, module) {
    module.doc() = "What ripplenotch/__init__.py is made of. Linked with FFTW: GPL-2.0-or-later.";
    module.attr("version") = std::string(ripplenotch::version());
    module.def("run", &ripplenotch::run_words, py::arg("words"),
               "Runs a command. Returns its exit code, the message of its error, standard output and "
               "standard error.");
    module.def("read", &ripplenotch::read_words, py::arg("path"), py::arg("words"),
               "Reads a log with options of a log. Returns exit code, the message of its error, and the "
               "fields of the log.");
}
