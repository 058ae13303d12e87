// Which parts of an octree to ask about in a pass, from the answers so far (D 3.2): processor code only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/queries.h"
#include "render/model/unit_costs.h"
#include "render/spatial/octree.h"
#include "render/spatial/query_box.h"
#include "render/strategy/estimate_load.h"
#include "render/strategy/guesses.h"
#include "render/strategy/query_plan.h"
#include "scene/held_bytes.h"

namespace scenegen::render {

/// Asks about *parts*: a chunk, or all chunks in the frustum below a node, by one box round them. A part that
/// is believed hidden governs its chunks and is asked in every frame in which it is not drawn; two parts
/// whose parent holds nothing else become one when the parent is found hidden too, and a parent that comes
/// into view falls apart into what was known of its parts. Parts that were visible are asked again after a
/// wait that doubles each time, spread over frames; everything depends on the answers and the frames' count
/// alone.
///
/// Parts that stay hidden share queries, several boxes to one (the multiqueries of CHC++, Mattausch, Bittner
/// and Wimmer 2008). Its answer is about all of them: when one comes into view all are drawn, and each is
/// asked by itself for a while. So as many share one as make what is drawn for nothing then, by how often
/// parts that stayed hidden came into view, cost what a query does; and more where a large share of the
/// nodes would be asked even so.
///
/// Three phases. *Gathering*: heavy parts (3.5) that were never asked are, largest first, some in each frame;
/// everything is drawn. Then hidden(x) is fitted and x* asked for; if that is 0, *resting*: nothing is asked
/// until the view has changed much or some time has passed. Else *asking*, fitted anew in each frame: what is
/// believed hidden, and of what may be hidden as much as leaves few of all answers that say visible, counted
/// over all frames, by how often such guesses were wrong, those first that are wrong least often: where most
/// around is hidden.
class QueryChooser {
 public:
  /// Parts never asked before that may be asked in a frame of gathering.
  static constexpr std::size_t kGatheredAtOnce = 64;

  struct Settings {
    bool exact = true;              ///< what is believed hidden is sent all the same, under a predicate
    bool indirect = true;           ///< chunks are indirect draws
    bool side_by_side = true;       ///< processor and device work at once
    std::uint32_t late_frames = 2;  ///< after which answers come
  };
  /// A frame; `visits` and `chunks` are what Octree::cull() found.
  struct Frame {
    const Octree& tree;
    std::span<const OctreeVisit> visits;
    std::span<const std::uint32_t> chunks;
    const QueryBoxes& boxes;
    const ScreenArea& screen;
    const model::UnitCosts& costs;
    double rerecorded_share = 0;   ///< alpha_n
    double commands_per_draw = 1;  ///< indirect draws: slots that are instances of one command share it
  };
  enum class Phase : std::uint8_t { gathering, asking, resting };

  explicit QueryChooser(const Settings& settings) : settings_(settings) {}
  /// Results (0: hidden) of what a plan of some frames ago asked.
  void learn(std::span<const Asked> asked, std::span<const std::uint32_t> samples);
  /// Fills an empty plan.
  void choose(const Frame& frame, QueryPlan& plan);
  /// From the next frame on it rests, as after asking for nothing: somebody knows that nothing is hidden; or
  /// such a rest is over.
  void rest(bool yes);

  /// Of a chunk by itself.
  [[nodiscard]] bool known_visible(std::uint32_t chunk) const {
    return chunk < chunks_.size() && chunks_[chunk].verdict == Verdict::visible;
  }
  [[nodiscard]] Phase phase() const { return phase_; }
  /// x* of the last frame: how many hidden parts it pays to ask about.
  [[nodiscard]] double best() const { return best_; }
  /// Host memory held.
  [[nodiscard]] std::uint64_t memory_bytes() const {
    return held_bytes(nodes_, chunks_, seconds_, draws_, seconds_of_chunk_, below_) +
           held_bytes(hidden_, unknown_, joined_, again_, batches_, query_of_, window_, points_, curve_);
  }

 private:
  enum class Verdict : std::uint8_t { unknown, visible, hidden };
  /// What is known of a chunk or a node.
  struct Part {
    std::uint64_t revision = 0;  // of what the verdict is about
    std::uint32_t owner = 0xFFFFFFFFU;
    std::uint32_t due = 0;   // frame from which on it may be asked again when visible
    std::uint32_t wait = 0;  // frames
    std::uint32_t age = 0;   // epoch of the verdict
    std::uint32_t seen = 0;  // last frame in the frustum
    std::uint32_t kept = 0;  // answers in a row that it is hidden
    Verdict verdict = Verdict::unknown;
    // When it was asked:
    float seconds = 0, draws = 0, chunks = 0;  // that hiding it saves
  };
  /// A part that could be asked now.
  struct Candidate {
    std::uint32_t part = 0;            // kNodeBit and a number
    std::uint32_t first = 0, end = 0;  // of the frame's chunks
    std::uint32_t level = 0;
    std::uint32_t rank = 0;  // order of the walk
    double seconds = 0;
    Box box_m;  // grown
    std::uint8_t guess = 0;
    double wrong = 0;     // how often such a guess says visible
    bool shares = false;  // may share a query
    double doubt = 1;     // that it is hidden still
  };
  /// Of hidden_, from `first` on: they share a query.
  struct Batch {
    std::uint32_t first = 0, count = 0;
    double seconds = 0, doubt = 0;
  };
  /// What a walk finds of everything below a visit.
  struct Below {
    Box box_m;
    bool hidden = true;    // every part is, as far as it would be asked
    bool known = false;    // some part has a verdict
    bool visible = false;  // some part was visible
    float known_parts = 0, hidden_parts = 0;
  };
  /// Why something is asked about that is not believed hidden: all below it is, it never was asked, or it was
  /// visible long ago.
  enum class Why : std::uint8_t { joined, never_asked, again };
  /// What is known around it: nothing, or how much of that is hidden.
  enum class Around : std::uint8_t { unknown, fifth, half, most, nearly_all };
  static constexpr std::size_t kWhys = 3, kArounds = 5;
  static_assert(kWhys * kArounds == Guesses::kKinds);
  /// Sums over queries.
  struct Sum {
    double queries = 0, chunks = 0, draws = 0, seconds = 0;
  };

  [[nodiscard]] Part& part_of(std::uint32_t key);
  Part& visit_part(std::uint32_t key, std::uint32_t owner, std::uint64_t revision);
  void learn_part(const Asked& asked, bool hidden, bool alone);
  void measure(const Frame& frame);
  void summarize(const Frame& frame);
  void collect(const Frame& frame, std::uint32_t visit, Around around);
  void collect_chunk(const Frame& frame, std::uint32_t index, std::uint32_t level, Around around);
  [[nodiscard]] bool make_candidate(const Frame& frame, std::uint32_t key, std::uint32_t first,
                                    std::uint32_t end, const Box& box_m, Candidate& out) const;
  [[nodiscard]] bool heavy(const Frame& frame, std::uint32_t first, std::uint32_t end) const;
  [[nodiscard]] double seconds_of(const Frame& frame, const Octree::Content& content) const;
  [[nodiscard]] double secondary_s(const Frame& frame, double draws) const;
  [[nodiscard]] static Around around_of(const Below& below, Around wider);
  [[nodiscard]] std::vector<Candidate>& list_of(Why why);
  void propose(Candidate candidate, Why why, Around around);
  [[nodiscard]] model::QueryProblem problem(const Frame& frame) const;
  [[nodiscard]] static double doubt(const Part& part);
  [[nodiscard]] double risk() const;
  void divide(double risk, double query_s);
  void share_queries(const Frame& frame);
  [[nodiscard]] std::size_t decide(const Frame& frame);
  void begin_gathering();
  void cut();
  void begin_resting();
  void gather(const Frame& frame, QueryPlan& plan);
  void ask_best(const Frame& frame, QueryPlan& plan);
  void ask(const Candidate& candidate, bool hidden, bool with_previous, QueryPlan& plan);
  void ask_some(std::vector<Candidate>& candidates, std::size_t most, QueryPlan& plan);
  void guess(std::vector<Candidate>& candidates, std::size_t most, double spare, QueryPlan& plan);
  void observe(const Sum& sum);

  static constexpr std::uint32_t kNodeBit = 0x80000000U;
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  Settings settings_;
  Phase phase_ = Phase::gathering;
  bool rest_next_ = false, told_to_rest_ = false;
  std::vector<Part> nodes_, chunks_;
  std::uint32_t frame_ = 0, epoch_ = 1;

  // Of the frame.
  std::vector<double> seconds_, draws_;  // sums before each of the frame's chunks
  std::vector<float> seconds_of_chunk_;  // by number, from some frames ago
  std::vector<Below> below_;             // by visit
  std::vector<Candidate> hidden_, unknown_, joined_, again_;
  std::vector<Batch> batches_;           // of hidden_
  std::vector<std::uint32_t> query_of_;  // by index of the frame's chunks

  // Statistics.
  Sum gathered_;
  std::vector<Sum> window_;  // a ring
  std::size_t window_at_ = 0;
  std::vector<model::Observation> points_;  // scratch
  std::vector<Sum> curve_;                  // of batches_, sorted: the first i of them
  double kept_share_ = 1;                   // of what was believed hidden, found so again
  double doubted_ = 0, revealed_ = 0;       // parts that stayed hidden, queries that found them visible
  Guesses guesses_;
  double best_ = 0;
  std::uint32_t last_asked_ = 0, useless_ = 0, wake_ = 0, rest_ = 0;
  double seconds_at_rest_ = 0, seconds_before_ = 0;
};

}  // namespace scenegen::render
