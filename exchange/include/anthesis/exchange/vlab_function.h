#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/function_graph.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

struct VlabFunctionPoint {
  Vec2 position;
  int multiplicity = 1;  ///< how often the point stands among the control points, 1 to 10,000
};

/// A function drawn as a curve over x in [0, 1]: `.func`, or one item of a `.fset`.
struct VlabFunction {
  std::string name;
  std::vector<VlabFunctionPoint> points;
  int samples = 0;       ///< entries of VLab's table, which keeps to 10 to 1,000; 0: not stated
  bool flipped = false;  ///< shown with its axes swapped in the editor; says nothing about the function
  std::string background;
  Vec2 background_offset;
};

/// A function of time: one item of a `.tset` timeline.
struct VlabTimedFunction {
  double start = 0.0;  ///< the time that x = 0 of the function stands for
  double end = 1.0;    ///< x = 1
  std::string name;
  std::string color;  ///< of the editor: "91,115,229"; may be empty
  std::string start_label;
  std::string end_label;
  VlabFunction function;

  /// The x that VLab's tfunc looks up at `time`, clamped to [0, 1].
  double x_at(double time) const;
};

/// What is wrong with a function that was made in code, if anything: 4 to 10,000 control points when repeated points
/// are written out, finite numbers, a name on one line.
std::optional<Error> check(const VlabFunction& function);

/// The functions of a gallery (`.fset`), or the one of a `.func` file; the old `.func` without samples too. Limits and
/// errors as in vlab_contour.h.
Expected<std::vector<VlabFunction>> read_vlab_functions(std::string_view text, std::string_view file_name);

/// The functions of a timeline (`.tset`).
Expected<std::vector<VlabTimedFunction>> read_vlab_timeline(std::string_view text, std::string_view file_name);

/// A `.func` file ("fver 1 1") and a `.fset` gallery, six digits after the point. Errors: check(function), and a name
/// or background that is not one line of at most 100 characters.
Expected<std::string> write_vlab_function(const VlabFunction& function);
Expected<std::string> write_vlab_functions(const std::vector<VlabFunction>& functions);

/// Control points with repeated ones written out.
std::vector<Vec2> vlab_controls(const VlabFunction& function);

/// The function itself, exactly: VLab's functions and ours are the same clamped uniform cubic B-splines.
/// Errors: points whose x does not ascend, for which VLab's answer depends on how it searches.
Expected<FunctionGraph> vlab_graph(const VlabFunction& function);

/// A function as models in VLab see it: a table with straight lines between. VLab finds each entry to 1 % of the
/// distance between entries and no better, and so does this, by the same steps. Agrees with VLab's `func` to 3e-4 of
/// the function's height, mostly to 1e-6. Where no number of samples is stated the table has 1,000 entries.
class VlabFunctionTable {
 public:
  /// Precondition: check(function) finds nothing.
  explicit VlabFunctionTable(const VlabFunction& function);

  double operator()(double x) const;  ///< x is clamped to [0, 1]

 private:
  std::vector<double> values_;
};

}  // namespace anthesis
