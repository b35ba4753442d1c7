// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "python/options.h"

#include <string>

#include "pliant/evaluation/evaluation.h"
#include "pliant/exchange/export.h"
#include "pliant/exchange/import.h"
#include "pliant/pipeline/calibrate_images.h"
#include "pliant/pipeline/join_runs.h"
#include "pliant/pipeline/refine_run.h"
#include "pliant/pipeline/surface_run.h"
#include "pliant/pipeline/track.h"
#include "pliant/simulation/options.h"
#include "pliant/viewer/figure.h"
#include "pliant/viewer/report.h"
#include "python/bind.h"
#include "python/errors.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

constexpr std::string_view kSwitchUnit = "off | on";

// NumPy's numbers and arrays too. An empty answer with `ok` false: a value of another kind.
std::string TextOf(const py::handle& value, const OptionField& field, bool* ok) {
  *ok = true;
  if (py::hasattr(value, "dtype") && py::hasattr(value, "tolist")) {
    const py::object plain = value.attr("tolist")();
    if (!py::hasattr(plain, "dtype")) return TextOf(plain, field, ok);  // a long double stays one of NumPy's
  }
  if (py::isinstance<py::str>(value)) return py::cast<std::string>(value);
  if (py::isinstance<py::bool_>(value)) {
    const bool on = py::cast<bool>(value);
    if (field.unit == kSwitchUnit) return on ? "on" : "off";
    return on ? "true" : "false";
  }
  // An array of no dimensions claims to be an index, whatever it holds.
  if (PyObject* const whole = PyNumber_Index(value.ptr()); whole != nullptr)
    return py::cast<std::string>(py::str(py::reinterpret_steal<py::object>(whole)));
  PyErr_Clear();
  if (PyNumber_Check(value.ptr()) != 0 && py::hasattr(value, "__float__"))
    return FormatDouble(py::cast<double>(py::float_(py::cast<py::object>(value))));
  if (py::hasattr(value, "__fspath__")) return py::cast<std::string>(value.attr("__fspath__")());
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    std::string text;
    for (const py::handle entry : value) {
      text += (text.empty() ? "" : ",") + TextOf(entry, field, ok);
      if (!*ok) return {};
    }
    return text;
  }
  *ok = false;
  return {};
}

// A default as Python's own type, where its text is of one.
py::object DefaultOf(const OptionField& field) {
  const std::string text = field.get();
  if (text == "true" || text == "false") return py::bool_(text == "true");
  int whole = 0;
  if (ParseInt(text, &whole)) return py::int_(whole);
  double number = 0;
  if (ParseDouble(text, &number)) return py::float_(number);
  return py::str(text);
}

// [(name, default, unit, sentence)], and the table as YAML.
template <class... Options>
py::tuple Listed(Options... options) {
  OptionTable table;
  (options.List(table), ...);
  py::list fields;
  for (const OptionField& field : table.fields())
    fields.append(py::make_tuple(field.name, DefaultOf(field), field.unit, field.why));
  return py::make_tuple(fields, table.ToYaml());
}

py::tuple ListOptions(const std::string& job, const std::string& preset) {
  if (job == "track") return Listed(MakeTrackOptions(EnumOf<Preset>(preset, "preset")));
  if (job == "calibrate") return Listed(CalibrateOptions());
  if (job == "simulate") return Listed(MakeSimulationOptions(EnumOf<Realism>(preset, "realism")));
  if (job == "refine") return Listed(RefineOptions());
  if (job == "join") return Listed(JoinOptions());
  if (job == "surface") return Listed(SurfaceRunOptions());
  if (job == "evaluate") return Listed(EvaluationOptions());
  if (job == "import") return Listed(ImportOptions());
  if (job == "export") return Listed(ExportOptions());
  if (job == "report") return Listed(ReportOptions(), FigureOptions());
  RaiseValueError(
      "there are no options of '" + job +
      "'; give one of track | calibrate | simulate | refine | join | surface | evaluate | import | export | report");
}

}  // namespace

void SetOptions(const py::object& options, OptionTable* table) {
  if (options.is_none()) return;
  if (!py::isinstance<py::dict>(options))
    RaiseTypeError("options are a dictionary of names and values, such as {'General.seed': 3}, not " +
                   py::cast<std::string>(py::str(py::type::of(options).attr("__name__"))));
  for (const auto& [key, value] : py::cast<py::dict>(options)) {
    const std::string name = py::cast<std::string>(py::str(key));
    const OptionField* field = table->Find(name);
    bool ok = true;
    const std::string text = TextOf(value, field == nullptr ? OptionField() : *field, &ok);
    if (!ok)
      RaiseValueError(name + " is a " + py::cast<std::string>(py::str(py::type::of(value).attr("__name__"))) +
                      "; give a number, a boolean, text, or a list of names");
    RaiseUnlessOk(table->Set(name, text));
  }
}

void BindOptions(py::module_& module) { module.def("list_options", &ListOptions, py::arg("job"), py::arg("preset")); }

}  // namespace pliant::python
