// SPDX-License-Identifier: MIT
// The Python module as C++ sees it: logs as arrays, and commands by their words. ripplenotch/__init__.py
// makes functions of it.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/options.hpp"
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

/// Bytes that commands read as files of these names.
using Files = std::map<std::string, std::string>;

/// `work` gives the code, or throws what commands throw. Other threads of Python run meanwhile.
template <class Work>
Ended ended(const Files& files, const Work& work) {
    const py::gil_scoped_release release;
    Guest guest;
    Ended end;
    try {
        std::vector<std::unique_ptr<HeldFile>> held;
        for (const auto& [name, bytes] : files) held.push_back(std::make_unique<HeldFile>(name, bytes));
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

py::tuple as_tuple(const Ended& end) {
    return py::make_tuple(static_cast<int>(end.code), end.error, py::bytes(end.output), end.talk);
}

py::tuple run_words(const CommandWords& words, const Files& files) {
    return as_tuple(ended(files, [&] { return run_within(words); }));
}

py::tuple figure_of_words(const CommandWords& words, const Files& files) {
    std::string data;
    Ended end = ended(files, [&] {
        const Answer answer = ask(words);
        data = figure_data(answer);
        return answer.code;
    });
    end.output = std::move(data);
    return as_tuple(end);
}

/// An array that owns the values.
py::array_t<double> array_of(std::vector<double>&& values) {
    auto* const kept = new std::vector<double>(std::move(values));
    const py::capsule owner(kept, [](void* gone) { delete static_cast<std::vector<double>*>(gone); });
    py::array_t<double> array(static_cast<py::ssize_t>(kept->size()), kept->data(), owner);
    return array;
}

/// Read-only, since it represents the log.
py::array_t<double> column_of(std::vector<double>&& values) {
    py::array_t<double> array = array_of(std::move(values));
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

py::object log_of(Log&& log) {
    py::dict fields;
    fields["joint"] = log.trace.joint;
    fields["joints"] = log.layout.joints;
    fields["torque_unit"] = log.recording.torque_unit;
    fields["sample_rate_hz"] = log.recording.clock.nominal_rate.value();
    fields["options"] = log.layout.options;
    std::vector<std::string> warnings;
    for (const auto* some : {&log.layout.warnings, &log.recording.warnings})
        for (const LogWarning& warning : *some) warnings.push_back(warning.text);
    fields["warnings"] = warnings;
    fields["time_s"] = column_of(std::move(log.trace.time_s));
    fields["velocity_deg_s"] = column_of(std::move(log.trace.velocity_deg_s));
    fields["torque_nm"] = column_of(std::move(log.trace.torque_nm));
    fields["position_deg"] = log.trace.position_deg.empty() ? py::object(py::none())
                                                            : column_of(std::move(log.trace.position_deg));
    return fields;
}

py::tuple torque_of_words(const CommandWords& words, const Files& files) {
    std::vector<double> torque_nm;
    const Ended end = ended(files, [&] {
        Answer answer = ask(words);
        torque_nm = std::move(answer.columns.at(0).values);
        return answer.code;
    });
    return py::make_tuple(static_cast<int>(end.code), end.error, array_of(std::move(torque_nm)), end.talk);
}

py::tuple read_words(const std::string& path, const CommandWords& words) {
    Log log;
    const Ended end = ended({}, [&] {
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
    module.def("run", &ripplenotch::run_words, py::arg("words"), py::arg("files"),
               "Runs a command, which reads these bytes as files of their names. Returns its exit code, the "
               "message of its error, standard output and standard error.");
    module.def("figure", &ripplenotch::figure_of_words, py::arg("words"), py::arg("files"),
               "The same with the data of the command's figure as JSON instead of standard output.");
    module.def("torque", &ripplenotch::torque_of_words, py::arg("words"), py::arg("files"),
               "The same of filter, with the torque that it makes as an array, in Nm; nothing is written.");
    module.def("read", &ripplenotch::read_words, py::arg("path"), py::arg("words"),
               "Reads a log with options of a log. Returns exit code, the message of its error, and the "
               "fields of the log.");
}
