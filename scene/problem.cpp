#include "scene/problem.hpp"

#include "scene/body_shape.hpp"
#include "scene/spelling.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

namespace sprung {
namespace {

/// Lengths of a scene are decimal numbers turned into doubles once; what differs by less than this
/// part of the channel is the same place.
constexpr double relative_tolerance = 1e-10;

constexpr std::array side_names{"left", "right", "bottom", "top", "back", "front"};

std::vector<std::string> sides_of(int dimension) {
  return {side_names.begin(), side_names.begin() + 2L * dimension};
}

Side side_named(const std::string& name) {
  const auto at = std::find(side_names.begin(), side_names.end(), name);
  return static_cast<Side>(at - side_names.begin());
}

std::string number_text(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

std::string point_text(const Point& point, int dimension) {
  std::string text = "(";
  for (int i = 0; i < dimension; ++i) text += (i ? ", " : "") + number_text(point[i]);
  return text + ") m";
}

std::string box_text(const Box& box, int dimension) {
  return "from " + point_text(box.from, dimension) + " to " + point_text(box.to, dimension);
}

double largest_extent(const Box& box) {
  double extent = 0.0;
  for (int i = 0; i < 3; ++i) extent = std::max(extent, box.to[i] - box.from[i]);
  return extent;
}

bool contains(const Box& box, const Point& point, double tolerance) {
  for (int i = 0; i < 3; ++i)
    if (point[i] < box.from[i] - tolerance || point[i] > box.to[i] + tolerance) return false;
  return true;
}

/// The coordinate of `box` that `side` bounds.
double coordinate(const Box& box, Side side) {
  const int index = static_cast<int>(side);
  return index % 2 == 0 ? box.from[index / 2] : box.to[index / 2];
}

/// [solid] and [probes] hold tables only.
void refuse_loose_keys(const Table& table, const std::string& example) {
  const auto tables = table.table_names();
  for (const auto& key : table.keys())
    if (std::find(tables.begin(), tables.end(), key) == tables.end())
      table.refuse(key, "[" + table.name() + "] holds a table for each name, such as " + example +
                            "; put this key into one");
}

/// Reads one scene; what it has read so far stands in `problem`.
class ProblemReader {
 public:
  explicit ProblemReader(const Document& document) : document_(document), root_(document.root()) {}

  Problem read() {
    problem_.title = root_.text("title");
    if (root_.has("source")) problem_.source = root_.text("source");
    read_domain();
    read_time_and_fluid();
    read_walls();
    read_wall_motion();
    read_periodic();
    read_curved_walls();
    read_forcing();
    read_inflow();
    read_outflow();
    read_solids();
    read_probes();
    read_record();
    return std::move(problem_);
  }

 private:
  Table required_table(const std::string& name, const std::string& example) const;
  Point read_point(const Table& table, const std::string& key) const;
  Box read_box(const Table& table) const;
  double positive(const Table& table, const std::string& key, const Dimension& dimension) const;
  int read_count(const Table& table, int least) const;
  std::vector<double> read_times(const Table& table) const;
  void claim(const Table& table, const std::string& key, Side side, const std::string& condition);
  void read_domain();
  void read_time_and_fluid();
  void read_viscosity(const Table& table);
  void read_walls();
  void read_wall_motion();
  void read_periodic();
  void read_curved_walls();
  CurvedWall read_curved_wall(const Table& table, const std::string& name) const;
  void read_shape(const Table& table, CurvedWall& wall) const;
  void read_polygon(const Table& table, CurvedWall& wall) const;
  void read_forcing();
  Waveform read_waveform(const Table& table) const;
  std::filesystem::path read_file(const Table& table) const;
  Point read_vector(const Table& table, const std::string& key, const Dimension& dimension,
                    const std::string& unit) const;
  void read_inflow();
  PressureSide read_pressure_side(const Table& table, Side side) const;
  void read_outflow();
  void read_solids();
  Solid read_solid(const Table& table, const std::string& name) const;
  void read_body(const Table& table, Solid& solid) const;
  bool overlap(const Solid& one, const Solid& other) const;
  void read_laws(const Table& table, Solid& solid) const;
  void check_clamp(const Table& table, const Solid& solid) const;
  void read_probes();
  void read_probe(const Table& table, const std::string& name);
  void read_displacement(const Table& table, const std::string& name);
  void read_profile(const Table& table, const std::string& name);
  void read_force(const Table& table, const std::string& name);
  void read_pressure(const Table& table, const std::string& name);
  std::string read_solid_name(const Table& table, const std::string& key) const;
  void read_record();
  double tolerance() const { return relative_tolerance * largest_extent(problem_.channel); }
  std::string solids_text() const;
  void check_name(const Table& table, const std::string& name, const std::string& kind) const;

  const Document& document_;
  Table root_;
  Problem problem_;
  std::map<Side, std::string> conditions_;  ///< what each side has been given
};

Table ProblemReader::required_table(const std::string& name, const std::string& example) const {
  if (!root_.has(name)) {
    for (const auto& present : root_.table_names())
      if (nearest_word(present, {name}) == name) root_.table(name);  // refuses, naming `present`
    root_.refuse("", "the table [" + name + "] is missing; write it, for instance\n  [" + name +
                         "]\n  " + example);
  }
  return root_.table(name);
}

Point ProblemReader::read_vector(const Table& table, const std::string& key,
                                 const Dimension& dimension, const std::string& unit) const {
  const auto coordinates = table.quantities(key, dimension);
  const auto wanted = static_cast<std::size_t>(problem_.dimension);
  if (coordinates.size() != wanted)
    table.refuse(key, std::to_string(coordinates.size()) + " coordinates where the channel has " +
                          std::to_string(wanted) + "; write [\"x " + unit + "\", \"y " + unit +
                          (wanted == 2 ? "\"]" : "\", \"z " + unit + "\"]"));
  Point point{};
  std::copy(coordinates.begin(), coordinates.end(), point.begin());
  return point;
}

Point ProblemReader::read_point(const Table& table, const std::string& key) const {
  return read_vector(table, key, dimension::length, "m");
}

/// A box as { from = [...], to = [...] }, of positive extent in every direction.
Box ProblemReader::read_box(const Table& table) const {
  const Box box{read_point(table, "from"), read_point(table, "to")};
  for (int i = 0; i < problem_.dimension; ++i)
    if (!(box.to[i] > box.from[i]))
      table.refuse("to",
                   "a box without extent, " + box_text(box, problem_.dimension) +
                       "; from is the corner with the smallest coordinates, to the one with the "
                       "largest");
  return box;
}

double ProblemReader::positive(const Table& table, const std::string& key,
                               const Dimension& dimension) const {
  const double value = table.quantity(key, dimension);
  if (!(value > 0.0)) table.refuse(key, "must be greater than zero; write " + describe(dimension));
  return value;
}

int ProblemReader::read_count(const Table& table, int least) const {
  constexpr long most = 1000000;
  const long points = table.integer("points");
  if (points < least || points > most)
    table.refuse("points", "must be from " + std::to_string(least) + " to " + std::to_string(most) +
                               "; write for instance points = 121");
  return static_cast<int>(points);
}

std::vector<double> ProblemReader::read_times(const Table& table) const {
  auto times = table.quantities("times", dimension::time);
  if (times.empty()) table.refuse("times", "names no time; write for instance times = [\"1 s\"]");
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] < 0.0)
      table.refuse("times",
                   number_text(times[i]) + " s lies before the start; write times from 0 s on");
    if (times[i] > problem_.end_time)
      table.refuse("times", number_text(times[i]) + " s lies beyond the end of the run at " +
                                number_text(problem_.end_time) +
                                " s; leave it out or raise end in [time]");
    if (i > 0 && !(times[i] > times[i - 1]))
      table.refuse("times", number_text(times[i]) + " s does not come after " +
                                number_text(times[i - 1]) +
                                " s; write the times in ascending order");
  }
  return times;
}

void ProblemReader::claim(const Table& table, const std::string& key, Side side,
                          const std::string& condition) {
  const auto [at, is_new] = conditions_.emplace(side, condition);
  if (!is_new)
    table.refuse(key, std::string("the side \"") + to_string(side) +
                          "\" has a condition already (" + at->second +
                          "); give every side one condition");
}

void ProblemReader::read_domain() {
  const Table domain = required_table(
      "domain", "channel = { from = [\"0 m\", \"0 m\"], to = [\"0.9 m\", \"0.3 m\"] }");
  const Table channel = domain.table("channel");
  const auto corner = channel.quantities("from", dimension::length);
  if (corner.size() != 2 && corner.size() != 3)
    channel.refuse("from",
                   std::to_string(corner.size()) +
                       " coordinates; write two for a plane problem, [\"0 m\", \"0 m\"], or three");
  problem_.dimension = static_cast<int>(corner.size());
  problem_.channel = read_box(channel);
}

void ProblemReader::read_time_and_fluid() {
  problem_.end_time = positive(required_table("time", "end = \"3 s\""), "end", dimension::time);
  problem_.density =
      positive(required_table("fluid", "density = \"1000 kg/m3\""), "density", dimension::density);
  if (root_.has("viscosity")) read_viscosity(root_.table("viscosity"));
}

void ProblemReader::read_viscosity(const Table& table) {
  Viscosity viscosity{positive(table, "dynamic", dimension::dynamic_viscosity), {}};
  if (table.has("carreau_yasuda")) {
    const Table law = table.table("carreau_yasuda");
    const auto above_zero = [&](const std::string& key) {
      const double value = law.number(key);
      if (!(value > 0.0) || !std::isfinite(value)) law.refuse(key, "must be positive");
      return value;
    };
    viscosity.carreau_yasuda = {positive(law, "high_shear", dimension::dynamic_viscosity),
                                positive(law, "relaxation_time", dimension::time),
                                above_zero("power"), above_zero("transition")};
  }
  problem_.viscosity = viscosity;
}

void ProblemReader::read_walls() {
  if (!root_.has("walls")) return;
  const Table table = root_.table("walls");
  Walls walls;
  const auto read = [&](const std::string& key, std::vector<Side>& sides) {
    if (!table.has(key)) return;
    for (const auto& name : table.words(key, sides_of(problem_.dimension))) {
      sides.push_back(side_named(name));
      claim(table, key, sides.back(), key + " in [walls]");
    }
  };
  read("no_slip", walls.no_slip);
  read("free_slip", walls.free_slip);
  for (const auto& key : table.keys()) {
    const auto meant = nearest_word(key, {"no_slip", "free_slip"});
    if (meant != key && !meant.empty())
      table.refuse(key, "unknown key; the nearest known word is " + meant);
  }
  if (walls.no_slip.empty() && walls.free_slip.empty())
    table.refuse("", "names no side; write no_slip = [\"bottom\", \"top\"] or remove the table");
  problem_.walls = walls;
}

void ProblemReader::read_wall_motion() {
  if (!root_.has("wall_motion")) return;
  const Table all = root_.table("wall_motion");
  refuse_loose_keys(all, "[wall_motion.top]");
  for (const auto& name : all.table_names()) {
    const Table table = all.table(name);
    WallMotion motion;
    const auto& walls = problem_.walls ? problem_.walls->no_slip : std::vector<Side>{};
    const auto at = std::find_if(walls.begin(), walls.end(),
                                 [&](Side side) { return name == to_string(side); });
    if (at == walls.end())
      table.refuse("", "\"" + name + "\" is no no-slip wall; name it in no_slip of [walls]");
    motion.side = *at;
    motion.velocity = read_vector(table, "velocity", dimension::velocity, "m/s");
    if (motion.velocity[static_cast<int>(motion.side) / 2] != 0.0)
      table.refuse("velocity",
                   "leads out of the wall's own plane; its part along the normal must "
                   "be \"0 m/s\"");
    motion.waveform = read_waveform(table);
    problem_.wall_motion.push_back(std::move(motion));
  }
}

void ProblemReader::read_periodic() {
  if (!root_.has("periodic")) return;
  const Table table = root_.table("periodic");
  Periodic periodic;
  const std::vector<std::string> names{"x", "y", "z"};
  const auto axes = table.words("axes", {names.begin(), names.begin() + problem_.dimension});
  if (axes.empty()) table.refuse("axes", "names no axis; write axes = [\"x\"] or remove the table");
  for (const auto& axis : axes) {
    const int d = axis[0] - 'x';
    periodic.axis[d] = true;
    claim(table, "axes", static_cast<Side>(2 * d), "[periodic]");
    claim(table, "axes", static_cast<Side>(2 * d + 1), "[periodic]");
  }
  problem_.periodic = periodic;
}

std::filesystem::path ProblemReader::read_file(const Table& table) const {
  const std::filesystem::path named = table.text("file");
  const auto file = named.is_absolute() ? named : document_.file().parent_path() / named;
  if (!std::filesystem::is_regular_file(file))
    table.refuse("file", "there is no such file; it is looked for as " + file.string());
  return file;
}

Waveform ProblemReader::read_waveform(const Table& table) const {
  if (!table.has("waveform")) return {};
  const Table waveform = table.table("waveform");
  if (waveform.has("formula") == waveform.has("file"))
    waveform.refuse("", "takes one of { formula = \"sin(2*pi*t)\" } and { file = \"beat.csv\" }");
  try {
    if (waveform.has("formula")) return Waveform::from_formula(waveform.text("formula"));
    return Waveform::from_file(read_file(waveform));
  } catch (const FormulaError& error) {
    waveform.refuse("formula", error.what());
  } catch (const SceneError&) {
    throw;
  } catch (const std::runtime_error& error) {
    waveform.refuse("file", error.what());
  }
}

/// Gravity and the velocity at the start.
void ProblemReader::read_forcing() {
  if (root_.has("gravity")) {
    const Table table = root_.table("gravity");
    Gravity gravity;
    gravity.acceleration = read_vector(table, "acceleration", dimension::acceleration, "m/s2");
    gravity.waveform = read_waveform(table);
    problem_.gravity = gravity;
  }
  if (!root_.has("initial")) return;
  const Table table = root_.table("initial");
  const auto components = table.texts("velocity");
  if (components.size() != static_cast<std::size_t>(problem_.dimension))
    table.refuse("velocity", std::to_string(components.size()) +
                                 " formulas where the velocity has " +
                                 std::to_string(problem_.dimension) +
                                 " components; write one for each, in m/s, of x, y and z in m");
  for (const auto& text : components) try {
      problem_.initial_velocity.emplace_back(text, std::vector<std::string>{"x", "y", "z"});
    } catch (const FormulaError& error) {
      table.refuse("velocity", "\"" + text + "\": " + error.what());
    }
}

void ProblemReader::read_curved_walls() {
  if (!root_.has("curved_wall")) return;
  const Table all = root_.table("curved_wall");
  refuse_loose_keys(all, "[curved_wall.cylinder]");
  for (const auto& name : all.table_names()) {
    const Table table = all.table(name);
    check_name(table, name, "curved wall");
    problem_.curved_walls.push_back(read_curved_wall(table, name));
  }
}

CurvedWall ProblemReader::read_curved_wall(const Table& table, const std::string& name) const {
  CurvedWall wall;
  wall.name = name;
  read_shape(table, wall);
  wall.fluid_inside = table.word("fluid", {"inside", "outside"}) == "inside";
  wall.no_slip = table.word("slip", {"no_slip", "free_slip"}) == "no_slip";
  return wall;
}

void ProblemReader::read_shape(const Table& table, CurvedWall& wall) const {
  const bool plane = problem_.dimension == 2;
  const std::vector<std::string> kinds = plane ? std::vector<std::string>{"circle", "polygon"}
                                               : std::vector<std::string>{"cylinder", "surface"};
  std::vector<std::string> present;
  for (const auto& kind : kinds)
    if (table.has(kind)) present.push_back(kind);
  if (present.size() != 1)
    table.refuse("", "its shape is " + list_words(kinds, false) + "; write exactly one");
  if (present[0] == "polygon") {
    read_polygon(table, wall);
    return;
  }
  const Table shape = table.table(present[0]);
  if (present[0] == "surface") {
    wall.shape = CurvedWall::Shape::surface;
    wall.file = read_file(shape);
    return;
  }
  wall.radius = positive(shape, "radius", dimension::length);
  if (plane) {
    wall.centre = read_point(shape, "centre");
    return;
  }
  wall.shape = CurvedWall::Shape::cylinder;
  wall.axis = shape.word("axis", {"x", "y", "z"})[0] - 'x';
  const auto centre = shape.quantities("centre", dimension::length);
  if (centre.size() != 2)
    shape.refuse("centre", "has two coordinates, in the plane across the axis");
  for (int d = 0, k = 0; d < 3; ++d)
    if (d != wall.axis) wall.centre[d] = centre[k++];
}

void ProblemReader::read_polygon(const Table& table, CurvedWall& wall) const {
  wall.shape = CurvedWall::Shape::polygon;
  for (const auto& row : table.quantity_rows("polygon", dimension::length)) {
    if (row.size() != 2) table.refuse("polygon", "its corners have two coordinates each");
    wall.corners.push_back({row[0], row[1], 0.0});
  }
  const std::size_t count = wall.corners.size();
  if (count < 3) table.refuse("polygon", "a polygon has three corners at least");
  double twice_area = 0.0, round = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const Point &a = wall.corners[k], &b = wall.corners[(k + 1) % count];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    if (length <= tolerance())
      table.refuse("polygon", "names the corner " + point_text(a, 2) +
                                  " twice in a row; name each once, the last is joined to the "
                                  "first");
    twice_area += a[0] * b[1] - a[1] * b[0];
    round += length;
  }
  if (std::abs(twice_area) <= relative_tolerance * round * round)
    table.refuse("polygon", "encloses no area; write its corners in order round it");
}

void ProblemReader::read_inflow() {
  if (!root_.has("inflow")) return;
  const Table table = root_.table("inflow");
  const Side side = side_named(table.word("side", sides_of(problem_.dimension)));
  claim(table, "side", side, "[inflow]");
  if (table.has("pressure")) {
    for (const char* key : {"profile", "mean_velocity", "ramp"})
      if (table.has(key))
        table.refuse(key,
                     "belongs to an inflow of prescribed velocity, and this one has a "
                     "pressure; remove one of them");
    problem_.pressure_inflow = read_pressure_side(table, side);
    return;
  }
  Inflow inflow;
  inflow.side = side;
  inflow.profile = table.word("profile", {"parabolic", "uniform"}) == "parabolic"
                       ? Inflow::Profile::parabolic
                       : Inflow::Profile::uniform;
  inflow.mean_velocity = positive(table, "mean_velocity", dimension::velocity);
  if (table.has("ramp")) inflow.ramp = table.quantity("ramp", dimension::time);
  if (inflow.ramp < 0.0)
    table.refuse("ramp", "must not be negative; write \"0 s\" for full speed from the start");
  inflow.waveform = read_waveform(table);
  problem_.inflow = inflow;
}

PressureSide ProblemReader::read_pressure_side(const Table& table, Side side) const {
  return {side, table.quantity("pressure", dimension::pressure), read_waveform(table)};
}

void ProblemReader::read_outflow() {
  if (!root_.has("outflow")) return;
  const Table table = root_.table("outflow");
  const Side side = side_named(table.word("side", sides_of(problem_.dimension)));
  claim(table, "side", side, "[outflow]");
  problem_.outflow = read_pressure_side(table, side);
}

/// Names become file names and names of series.
void ProblemReader::check_name(const Table& table, const std::string& name,
                               const std::string& kind) const {
  const bool letters = !name.empty() && std::isalpha(static_cast<unsigned char>(name.front())) &&
                       std::all_of(name.begin(), name.end(), [](unsigned char c) {
                         return c < 0x80 && (std::isalnum(c) || c == '_');
                       });
  if (!letters)
    table.refuse("", "\"" + name + "\" cannot name a " + kind +
                         "; use letters, digits and _, a letter first");
  if (name.starts_with("ledger_"))
    table.refuse("", "names that begin with ledger_ belong to the solvers; choose another");
}

void ProblemReader::read_solids() {
  if (!root_.has("solid")) return;
  const Table table = root_.table("solid");
  const auto names = table.table_names();
  refuse_loose_keys(table, "[solid.beam]");
  if (names.empty())
    table.refuse("", "holds no body; write a table for each, such as [solid.beam]");
  for (const auto& name : names) {
    const Table body = table.table(name);
    check_name(body, name, "body");
    for (const auto& wall : problem_.curved_walls)
      if (wall.name == name)
        body.refuse("", "[curved_wall." + name +
                            "] has this name already, and probes name both; choose another");
    problem_.solids.push_back(read_solid(body, name));
  }
}

Solid ProblemReader::read_solid(const Table& table, const std::string& name) const {
  Solid solid;
  solid.name = name;
  read_body(table.table("body"), solid);
  const Box reach = bounding_box(solid, problem_.dimension);
  if (!contains(problem_.channel, reach.from, tolerance()) ||
      !contains(problem_.channel, reach.to, tolerance()))
    table.refuse("body", "the body reaches " + box_text(reach, problem_.dimension) +
                             ", out of the channel, which reaches " +
                             box_text(problem_.channel, problem_.dimension) +
                             "; move or shrink the body, or enlarge the channel");
  for (const auto& other : problem_.solids) {
    if (overlap(solid, other))
      table.refuse("body",
                   "the body overlaps [solid." + other.name + "], which reaches " +
                       box_text(bounding_box(other, problem_.dimension), problem_.dimension) +
                       "; move one of them");
  }
  solid.youngs_modulus = positive(table, "youngs_modulus", dimension::pressure);
  if (table.has("clamped")) {
    solid.clamped = side_named(table.word("clamped", sides_of(problem_.dimension)));
    check_clamp(table, solid);
  }
  read_laws(table, solid);
  return solid;
}

/// What a body's springs do beyond a linear force, each in a table of its own.
void ProblemReader::read_laws(const Table& table, Solid& solid) const {
  if (table.has("stiffening")) {
    const Table law = table.table("stiffening");
    solid.stiffening = {law.number("ratio"), law.number("toe_strain")};
    if (!(solid.stiffening->ratio >= 1.0))
      law.refuse("ratio", "the modulus beyond the toe over youngs_modulus, must be 1 or more");
    if (!(solid.stiffening->toe_strain > 0.0 && solid.stiffening->toe_strain < 1.0))
      law.refuse("toe_strain", "must lie between 0 and 1, such as 0.1");
  }
  if (table.has("viscoelastic")) {
    const Table law = table.table("viscoelastic");
    solid.viscoelasticity = {positive(law, "modulus", dimension::pressure),
                             positive(law, "relaxation_time", dimension::time)};
  }
  if (table.has("fibre")) {
    constexpr double degree = std::numbers::pi / 180.0;
    const Table law = table.table("fibre");
    Fibre fibre;
    fibre.angle = degree * law.number("angle_degrees");
    if (problem_.dimension == 3) fibre.elevation = degree * law.number("elevation_degrees");
    fibre.modulus = positive(law, "modulus", dimension::pressure);
    solid.fibre = fibre;
  }
}

/// { from, to }, { from, to, angle_degrees }, or part of a ring.
void ProblemReader::read_body(const Table& table, Solid& solid) const {
  constexpr double degree = std::numbers::pi / 180.0;
  if (!table.has("centre")) {
    solid.body = read_box(table);
    if (table.has("angle_degrees")) solid.angle = degree * table.number("angle_degrees");
    return;
  }
  Arc arc;
  const auto centre = table.quantities("centre", dimension::length);
  if (centre.size() != 2)
    table.refuse("centre",
                 std::to_string(centre.size()) +
                     " coordinates; a ring lies in the x-y plane, write [\"x m\", \"y m\"]");
  std::copy(centre.begin(), centre.end(), arc.centre.begin());
  arc.inner_radius = positive(table, "inner_radius", dimension::length);
  arc.outer_radius = positive(table, "outer_radius", dimension::length);
  if (!(arc.outer_radius > arc.inner_radius))
    table.refuse("outer_radius", "must be larger than inner_radius");
  arc.from_angle = degree * table.number("from_degrees");
  arc.to_angle = degree * table.number("to_degrees");
  if (!(arc.to_angle > arc.from_angle) || arc.to_angle - arc.from_angle > 350.0 * degree)
    table.refuse("to_degrees",
                 "must lie beyond from_degrees, anticlockwise, and by 350 degrees at most");
  solid.arc = arc;
  if (problem_.dimension == 3) {
    const auto z = table.quantities("z", dimension::length);
    if (z.size() != 2 || !(z[1] > z[0]))
      table.refuse("z", "must be the two ends along z, such as [\"0 m\", \"0.1 m\"]");
    solid.body.from[2] = z[0];
    solid.body.to[2] = z[1];
  }
  const Box box = bounding_box(solid, problem_.dimension);
  for (int d = 0; d < 2; ++d) {
    solid.body.from[d] = box.from[d];
    solid.body.to[d] = box.to[d];
  }
}

/// Boxes along the axes: exactly. A body at an angle: points of its surface, 200 along each edge,
/// in the other body.
bool ProblemReader::overlap(const Solid& one, const Solid& other) const {
  const Box a = bounding_box(one, problem_.dimension), b = bounding_box(other, problem_.dimension);
  for (int i = 0; i < problem_.dimension; ++i)
    if (a.from[i] >= b.to[i] - tolerance() || b.from[i] >= a.to[i] - tolerance()) return false;
  if (!is_oblique(one) && !is_oblique(other)) return true;
  constexpr int steps = 200;
  const auto reaches_into = [&](const Solid& inner, const Solid& outer) {
    const Point extent = own_extent(inner);
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= steps; ++j) {
        if (i % steps != 0 && j % steps != 0 && (i != steps / 2 || j != steps / 2)) continue;
        const Point own{extent[0] * i / steps, extent[1] * j / steps, 0.5 * extent[2]};
        if (body_contains(outer, from_own(inner, own), -tolerance())) return true;
      }
    return false;
  };
  return reaches_into(one, other) || reaches_into(other, one);
}

void ProblemReader::check_clamp(const Table& table, const Solid& solid) const {
  if (is_oblique(solid)) return;  // its own side, held where it is
  const Side side = *solid.clamped;
  const double body = coordinate(solid.body, side);
  const double wall = coordinate(problem_.channel, side);
  const std::string axis(1, "xyz"[static_cast<int>(side) / 2]);
  const std::string name = to_string(side);
  if (std::abs(body - wall) > tolerance())
    table.refuse("clamped", "the body ends at " + axis + " = " + number_text(body) +
                                " m and does not touch the side \"" + name +
                                "\" of the channel at " + axis + " = " + number_text(wall) +
                                " m; move the body there or clamp it to the side that it touches");
  if ((problem_.inflow && problem_.inflow->side == side) ||
      (problem_.pressure_inflow && problem_.pressure_inflow->side == side) ||
      (problem_.outflow && problem_.outflow->side == side))
    table.refuse("clamped", "fluid passes through the side \"" + name +
                                "\"; clamp the body to a wall or move the opening");
}

void ProblemReader::read_probes() {
  if (!root_.has("probes")) return;
  const Table table = root_.table("probes");
  const auto names = table.table_names();
  refuse_loose_keys(table, "[probes.tip]");
  if (names.empty())
    table.refuse("", "holds no probe; write a table for each, such as [probes.tip], or remove it");
  for (const auto& name : names) {
    const Table probe = table.table(name);
    check_name(probe, name, "probe");
    read_probe(probe, name);
  }
}

void ProblemReader::read_probe(const Table& table, const std::string& name) {
  const std::vector<std::string> kinds{"displacement_of", "velocity_along", "force_on",
                                       "outline_of", "pressure_at"};
  std::vector<std::string> present;
  for (const auto& kind : kinds)
    if (table.has(kind)) present.push_back(kind);
  if (present.empty()) {
    for (const auto& key : table.keys()) {
      const auto meant = nearest_word(key, kinds);
      if (!meant.empty()) table.refuse(key, "unknown key; the nearest known word is " + meant);
    }
    table.refuse("", "measures nothing; write exactly one of " + list_words(kinds, false));
  }
  if (present.size() > 1)
    table.refuse(present[1], "a probe measures one thing, and this one has " +
                                 list_words(present, false, "and") +
                                 "; give each a table of its own");
  if (present[0] == "displacement_of") {
    read_displacement(table, name);
  } else if (present[0] == "velocity_along") {
    read_profile(table, name);
  } else if (present[0] == "force_on") {
    read_force(table, name);
  } else if (present[0] == "pressure_at") {
    read_pressure(table, name);
  } else {
    if (problem_.dimension != 2)
      table.refuse("outline_of", "outlines are for plane problems; remove this probe");
    OutlineProbe probe{name, read_solid_name(table, "outline_of"), 0, {}};
    probe.points = read_count(table, 4);
    probe.times = read_times(table);
    problem_.probes.outline.push_back(std::move(probe));
  }
}

std::string ProblemReader::solids_text() const {
  std::string text;
  for (const auto& solid : problem_.solids)
    text += (text.empty() ? "[solid." : ", [solid.") + solid.name + "] reaches " +
            box_text(solid.body, problem_.dimension);
  return text;
}

void ProblemReader::read_displacement(const Table& table, const std::string& name) {
  DisplacementProbe probe{name, read_point(table, "displacement_of"), ""};
  if (problem_.solids.empty())
    table.refuse("displacement_of",
                 "the scene has no solid; add one, such as [solid.beam], or remove "
                 "this probe");
  for (const auto& solid : problem_.solids)
    if (probe.solid.empty() && body_contains(solid, probe.point, tolerance()))
      probe.solid = solid.name;
  if (probe.solid.empty())
    table.refuse("displacement_of", "the point " + point_text(probe.point, problem_.dimension) +
                                        " lies in no body (" + solids_text() +
                                        "); name a point of a body as it is at the start");
  problem_.probes.displacement.push_back(std::move(probe));
}

void ProblemReader::read_profile(const Table& table, const std::string& name) {
  const Table along = table.table("velocity_along");
  VelocityProfileProbe probe;
  probe.name = name;
  probe.from = read_point(along, "from");
  probe.to = read_point(along, "to");
  for (const auto& [key, point] : {std::pair("from", probe.from), std::pair("to", probe.to)})
    if (!contains(problem_.channel, point, tolerance()))
      along.refuse(key, "the point " + point_text(point, problem_.dimension) +
                            " lies outside the channel, which reaches " +
                            box_text(problem_.channel, problem_.dimension) + "; move it inside");
  if (probe.from == probe.to)
    along.refuse("to", "the same point as from; write the line's other end");
  probe.points = read_count(along, 2);
  probe.times = read_times(table);
  problem_.probes.velocity_profile.push_back(std::move(probe));
}

void ProblemReader::read_force(const Table& table, const std::string& name) {
  std::vector<std::string> names;
  for (const auto& wall : problem_.curved_walls) names.push_back(wall.name);
  const auto walls = static_cast<std::ptrdiff_t>(names.size());
  for (const auto& solid : problem_.solids) names.push_back(solid.name);
  if (names.empty())
    table.refuse("force_on",
                 "the scene has no solid and no curved wall; add one, such as [solid.beam], or "
                 "remove this probe");
  const std::string on = table.word("force_on", names);
  const bool is_wall = std::find(names.begin(), names.begin() + walls, on) < names.begin() + walls;
  problem_.probes.force.push_back({name, is_wall ? "" : on, is_wall ? on : ""});
}

void ProblemReader::read_pressure(const Table& table, const std::string& name) {
  PressureProbe probe{name, {}};
  for (const auto& row : table.quantity_rows("pressure_at", dimension::length)) {
    Point place{};
    if (row.size() != static_cast<std::size_t>(problem_.dimension))
      table.refuse("pressure_at", "each place has " + std::to_string(problem_.dimension) +
                                      " coordinates, such as [[\"0 m\", \"0 m\"]]");
    std::copy(row.begin(), row.end(), place.begin());
    if (!contains(problem_.channel, place, tolerance()))
      table.refuse("pressure_at", "the point " + point_text(place, problem_.dimension) +
                                      " lies outside the channel, which reaches " +
                                      box_text(problem_.channel, problem_.dimension) +
                                      "; move it inside");
    probe.places.push_back(place);
  }
  if (probe.places.empty()) table.refuse("pressure_at", "names no place");
  problem_.probes.pressure.push_back(std::move(probe));
}

std::string ProblemReader::read_solid_name(const Table& table, const std::string& key) const {
  std::vector<std::string> names;
  for (const auto& solid : problem_.solids) names.push_back(solid.name);
  if (names.empty())
    table.refuse(key,
                 "the scene has no solid; add one, such as [solid.beam], or remove this probe");
  return table.word(key, names);
}

/// Field output and the probes' own times, merged. A field time that is a probe's time up to
/// rounding takes the probe's value, which is the decimal number of the scene file.
void ProblemReader::read_record() {
  auto& all = problem_.probes.all_times;
  for (const auto& probe : problem_.probes.velocity_profile)
    all.insert(all.end(), probe.times.begin(), probe.times.end());
  for (const auto& probe : problem_.probes.outline)
    all.insert(all.end(), probe.times.begin(), probe.times.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());

  const Table table = document_.table_or_new("record");
  const double every = table.quantity_or("fields_every", dimension::time, "0 s");
  if (every < 0.0)
    table.refuse("fields_every", "must not be negative; write \"0 s\" for the probes' times only");
  problem_.fields_every = every;
  if (every == 0.0) return;
  constexpr double most_snapshots = 100000;
  if (problem_.end_time / every > most_snapshots)
    table.refuse("fields_every", "more than " + number_text(most_snapshots) +
                                     " snapshots until the end; write a longer interval");
  const double near = relative_tolerance * problem_.end_time;
  const auto probe_times = all;
  const auto last =
      std::llround(std::floor(problem_.end_time / every * (1.0 + relative_tolerance)));
  for (long long i = 0; i <= last; ++i) {
    const double time = std::min(static_cast<double>(i) * every, problem_.end_time);
    const auto next = std::lower_bound(probe_times.begin(), probe_times.end(), time - near);
    if (next == probe_times.end() || *next > time + near) all.push_back(time);
  }
  std::sort(all.begin(), all.end());
}

}  // namespace

const char* to_string(Side side) {
  return side_names[static_cast<std::size_t>(side)];
}

double Inflow::speed(double s, double height, double t) const {
  const double start = (ramp > 0.0 ? std::clamp(t / ramp, 0.0, 1.0) : 1.0) * waveform.value(t);
  if (profile == Profile::uniform) return mean_velocity * start;
  return 6.0 * mean_velocity * s * (height - s) / (height * height) * start;
}

Problem read_problem(const Document& document) {
  return ProblemReader(document).read();
}

}  // namespace sprung
