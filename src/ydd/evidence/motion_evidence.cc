// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/motion_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ydd {
namespace {

constexpr double kPairAge_s = 0.27;  // movers have left their place by then, most views remain
constexpr double kGlance_s = 0.1;    // motion over less than that is seen once and no more
constexpr std::array<double, 6> kWitnessAges_s = {0.1, 0.2, 0.4, 0.8, 1.6, 3.2};
constexpr double kLongAgo_s = 0.8;   // what was there then stands still
constexpr double kJustNow_s = 0.5;   // what has come since then moves
constexpr float kCameBefore = 0.1F;  // what came before that: its share
constexpr double kMemory_s = 4.0;
constexpr float kMostArea_m2 = 0.2F;  // of a piece, that counts
constexpr int kFeaturesOfPiece = 4;   // beyond these, more say no more
constexpr unsigned kYoung = 45;       // frames in which a map of the room is begun
constexpr float kUneasy = 0.5F;       // log-odds that end a calm
constexpr float kStartled = 0.5F;     // gathered from one frame: it does, too
constexpr int kProposals = 40;
constexpr double kSame_m = 0.003, kSame_rad = 0.003;  // poses that make the same evidence

/// Close together what is new, farther apart what is old.
double spacing_s(double age_s) {
  if (age_s < 0.25) return 0.0;
  return age_s < 0.9 ? 0.09 : 0.39;
}

/// Features with a depth that later frames look for: some of every place, fewer of what moves.
std::shared_ptr<const Features> some_of(const Features& features, const MotionOdds& odds,
                                        int most_of_place) {
  const int place_px = 4 * odds.depth.grid.cell_px;
  const int columns = odds.depth.grid.columns / 4 + 1;
  const int rows = odds.depth.grid.rows / 4 + 1;
  std::vector<int> taken(static_cast<std::size_t>(columns * rows), 0);
  std::vector<int> chosen;
  chosen.reserve(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features.has_depth(i)) continue;
    const Keypoint& k = features.keypoints[i];
    const int cell = odds.cell_at(k.x_px, k.y_px, features.depth_m[i]);
    if (cell < 0) continue;
    const int place =
        static_cast<int>(k.y_px) / place_px * columns + static_cast<int>(k.x_px) / place_px;
    const bool moves = odds.moves[static_cast<std::size_t>(cell)] != 0;
    const int most = moves ? (most_of_place + 1) / 2 : most_of_place;
    if (++taken[static_cast<std::size_t>(place)] > most) continue;
    chosen.push_back(static_cast<int>(i));
  }
  return std::make_shared<const Features>(select(features, chosen));
}

/// How far the least residuals of pieces exceed what the noise model says of them: 40 % of the
/// weight has less than 1.87 by chi-square with 3 degrees of freedom.
double excess_of(std::span<const PieceMotion> motions, std::span<const float> weight) {
  constexpr double kShare = 0.4, kChi2 = 1.87;
  constexpr std::size_t kLeastPieces = 5;
  std::vector<std::pair<double, double>> sorted;
  sorted.reserve(motions.size());
  double total = 0;
  for (const PieceMotion& m : motions) {
    const double w = weight[static_cast<std::size_t>(m.piece)];
    sorted.emplace_back(m.chi2, w);
    total += w;
  }
  if (sorted.size() < kLeastPieces) return 1;
  std::sort(sorted.begin(), sorted.end());
  double reached = 0;
  for (const auto& [chi2, w] : sorted) {
    reached += w;
    if (reached >= kShare * total) return chi2 / kChi2;
  }
  return 1;
}

}  // namespace

MotionEvidence::MotionEvidence(const EvidenceOptions& options, const Camera& camera)
    : options_(options.at_width(camera.width_px)),
      camera_(camera),
      rays_(cell_rays(camera, CellGrid(camera.width_px, camera.height_px, options_.cell_px))) {}

void MotionEvidence::clear() {
  seen_.clear();
  T_now_last_.reset();
  now_.reset();
  last_pieces_.reset();
  odds_ = {};
  excess_ = 1;
  frames_ = 0;
}

double MotionEvidence::trust() const {
  return frames_ < kYoung ? options_.trust : options_.trust_grown;
}

SE3 MotionEvidence::predicted_pose(Timestamp stamp) const {
  if (!T_now_last_ || interval_s_ <= 0) return T_origin_last_;
  constexpr double kLongest = 4.0;  // nobody keeps a speed for long
  const double intervals = seconds_between(last_stamp_, stamp) / interval_s_;
  const double steps = std::clamp(intervals, 0.0, kLongest);
  return T_origin_last_ * SE3::exp(steps * T_now_last_->log()).inverse();
}

const MotionEvidence::Seen& MotionEvidence::nearest_age(Timestamp stamp, double age_s) const {
  const auto off_s = [&](const Seen& s) {
    return std::abs(seconds_between(s.stamp, stamp) - age_s);
  };
  return *std::min_element(seen_.begin(), seen_.end(),
                           [&](const Seen& a, const Seen& b) { return off_s(a) < off_s(b); });
}

std::vector<const MotionEvidence::Seen*> MotionEvidence::witnesses() const {
  // Each frame hears every other one, the next frame the rest: they change little.
  std::vector<const Seen*> out;
  for (std::size_t i = frames_ % 2; i < kWitnessAges_s.size(); i += 2) {
    const Seen* s = &nearest_age(now_->stamp, kWitnessAges_s[i]);
    if (out.empty() || out.back() != s) out.push_back(s);
  }
  return out;
}

const MotionOdds& MotionEvidence::look(std::shared_ptr<const Features> features,
                                       const DepthImage& depth_m, Timestamp stamp) {
  if (now_) settle(std::nullopt, {});
  now_ = Seen{stamp, std::move(features), coarse_depth(depth_m, options_.cell_px), SE3()};
  ++frames_;
  if (seen_.empty()) {
    odds_ = carried_odds({}, now_->depth, SE3(), camera_, rays_, options_);
    return odds_;
  }
  const Seen& last = seen_.back();
  const SE3 T_origin_expected = predicted_pose(stamp);
  before_ = std::move(odds_);
  carried_ = carried_odds(before_, now_->depth, last.T_origin_camera.inverse() * T_origin_expected,
                          camera_, rays_, options_);
  odds_ = carried_;
  points_ = points_on(rays_, now_->depth.z_m);
  surfaces_ = find_surfaces(now_->depth, rays_, options_);
  grid_ = KeypointGrid(*now_->features, camera_);
  earlier_ = &nearest_age(stamp, kPairAge_s);
  pieces_ = paired(*earlier_, T_origin_expected);
  if (earlier_ != &last) last_pieces_ = paired(last, T_origin_expected);
  weight_ = piece_weights();
  const SE3 T_now_earlier = pieces_->consensus(
      T_origin_expected.inverse() * earlier_->T_origin_camera, weight_, kProposals, frames_);
  const SE3 T_origin_now = earlier_->T_origin_camera * T_now_earlier.inverse();
  set_excess(T_origin_now);
  judge(T_origin_now);
  return odds_;
}

void MotionEvidence::settle(const std::optional<SE3>& T_now_last, std::vector<float> prior) {
  if (!now_) return;
  if (!seen_.empty() && T_now_last) {
    const SE3 tracked = T_origin_last_ * T_now_last->inverse();
    const auto support = [&](const SE3& T_origin_now) {
      return pieces_->support(T_origin_now.inverse() * earlier_->T_origin_camera, weight_).agreeing;
    };
    const SE3 off = now_->T_origin_camera.inverse() * tracked;
    if (support(tracked) >= trust() * support(now_->T_origin_camera)) {
      if (off.translation().norm() > kSame_m || off.angle_rad() > kSame_rad) judge(tracked);
      now_->T_origin_camera = tracked;
    }
  }
  odds_.prior = std::move(prior);
  remember();
}

void MotionEvidence::withhold(const std::optional<SE3>& T_now_last) {
  if (!now_) return;
  if (seen_.empty()) return clear();
  move_on(T_now_last ? T_origin_last_ * T_now_last->inverse() : predicted_pose(now_->stamp));
  odds_ = std::move(before_);
  last_pieces_.reset();
  now_.reset();
}

void MotionEvidence::set_excess(const SE3& T_origin_now) {
  const double excess =
      excess_ *
      excess_of(pieces_->motions(T_origin_now.inverse() * earlier_->T_origin_camera), weight_);
  pieces_->set_excess(std::max(excess, excess_));
  excess_ = std::clamp(0.9 * excess_ + 0.1 * excess, 1.0, 30.0);
}

void MotionEvidence::judge(const SE3& T_origin_now) {
  now_->T_origin_camera = T_origin_now;
  odds_ = carried_;
  std::vector<float> gathered(static_cast<std::size_t>(surfaces_.count), 0.0F);
  gather_motions(*earlier_, *pieces_, gathered);
  if (last_pieces_) gather_motions(seen_.back(), *last_pieces_, gathered);
  gather_space(gathered);
  conclude(gathered);
}

std::vector<int> MotionEvidence::pieces_of(std::span<const FeaturePair> pairs) const {
  std::vector<int> out;
  out.reserve(pairs.size());
  for (const FeaturePair& pair : pairs) {
    const auto k = static_cast<std::size_t>(pair.now);
    const Keypoint& keypoint = now_->features->keypoints[k];
    const int cell = odds_.cell_at(keypoint.x_px, keypoint.y_px, now_->features->depth_m[k]);
    out.push_back(cell < 0 ? -1 : surfaces_.piece[static_cast<std::size_t>(cell)]);
  }
  return out;
}

PairedPieces MotionEvidence::paired(const Seen& then, const SE3& T_origin_now) const {
  const std::vector<FeaturePair> pairs =
      pair_features(*then.features, *now_->features, grid_,
                    T_origin_now.inverse() * then.T_origin_camera, camera_, options_);
  PairedPieces pieces(*then.features, *now_->features, pairs, pieces_of(pairs), camera_, options_);
  pieces.set_excess(excess_);
  pieces.add_depth(now_->depth, surfaces_, rays_, then.depth);
  return pieces;
}

/// What each piece of surface vouches for: its area, by what is known of it.
std::vector<float> MotionEvidence::piece_weights() const {
  struct Sum {
    float area_m2 = 0, z_m = 0, log_odds = 0, cells = 0;
  };
  std::vector<Sum> sums(static_cast<std::size_t>(surfaces_.count));
  const auto cell_share = static_cast<float>(options_.cell_px / camera_.fx_px);
  for (std::size_t i = 0; i < surfaces_.piece.size(); ++i) {
    if (surfaces_.piece[i] < 0) continue;
    Sum& sum = sums[static_cast<std::size_t>(surfaces_.piece[i])];
    const float z_m = now_->depth.z_m[i];
    sum.area_m2 += cell_share * z_m * cell_share * z_m;
    sum.z_m += z_m;
    sum.log_odds += odds_.log_odds[i] + (odds_.prior.empty() ? 0.0F : odds_.prior[i]);
    sum.cells += 1;
  }
  std::vector<float> weight;
  weight.reserve(sums.size());
  for (const Sum& sum : sums) {
    const float still = std::max(0.02F, 1.0F / (1.0F + std::exp(sum.log_odds / sum.cells)));
    // A room is behind what moves in it.
    const float behind = std::clamp(sum.z_m / sum.cells / 1.5F, 0.5F, 2.0F);
    weight.push_back(std::min(sum.area_m2, kMostArea_m2) * behind * still);
  }
  return weight;
}

void MotionEvidence::gather_space(std::span<float> gathered) const {
  const std::size_t cells = now_->depth.z_m.size();
  std::vector<float> intrusion(cells, 0.0F), presence(cells, 0.0F);
  SeenFrom::Places places;
  std::vector<Space> space;
  for (const Seen* then : witnesses()) {
    const double age_s = seconds_between(then->stamp, now_->stamp);
    space_then(points_, then->depth, then->T_origin_camera.inverse() * now_->T_origin_camera,
               camera_, options_, places, space);
    const auto still = static_cast<float>(std::min(1.0, age_s / kLongAgo_s));
    const float came = age_s <= kJustNow_s ? 1.0F : kCameBefore;
    for (std::size_t i = 0; i < cells; ++i) {
      if (space[i] == Space::empty) intrusion[i] = std::max(intrusion[i], came);
      if (space[i] == Space::same) presence[i] = std::max(presence[i], still);
    }
  }
  std::vector<float> sum(gathered.size(), 0.0F);
  std::vector<int> size(gathered.size(), 0);
  for (std::size_t i = 0; i < cells; ++i) {
    if (surfaces_.piece[i] < 0) continue;
    const auto piece = static_cast<std::size_t>(surfaces_.piece[i]);
    ++size[piece];
    // What slides in its own plane, like a scrolling picture, is at the same depth all the time.
    const float still = gathered[piece] > 0 ? 0.0F : static_cast<float>(options_.presence_gain);
    sum[piece] += intrusion[i] > 0 ? static_cast<float>(options_.intrusion_gain) * intrusion[i]
                                   : -still * presence[i];
  }
  constexpr int kFew = 4;  // cells that are no surface
  for (std::size_t p = 0; p < sum.size(); ++p) {
    gathered[p] += sum[p] / static_cast<float>(std::max(kFew, size[p]));
  }
}

void MotionEvidence::gather_motions(const Seen& then, const PairedPieces& pieces,
                                    std::span<float> gathered) const {
  const double age_s = seconds_between(then.stamp, now_->stamp);
  const auto moved_share = static_cast<float>(std::min(1.0, age_s / kGlance_s));
  const auto still_share = static_cast<float>(std::min(1.0, std::pow(age_s / kPairAge_s, 2)));
  const SE3 T_now_then = now_->T_origin_camera.inverse() * then.T_origin_camera;
  for (const PieceMotion& motion : pieces.motions(T_now_then)) {
    float& piece = gathered[static_cast<std::size_t>(motion.piece)];
    const auto gain =
        static_cast<float>(options_.feature_gain * std::min(kFeaturesOfPiece, motion.pairs));
    if (motion.chi2 > options_.moved_chi2) piece += gain * moved_share;
    if (motion.chi2 < options_.still_chi2) piece -= gain * still_share;
  }
}

void MotionEvidence::conclude(std::span<const float> gathered) {
  const auto most = static_cast<float>(options_.most_log_odds);
  const auto step_s = static_cast<float>(seconds_between(seen_.back().stamp, now_->stamp));
  for (std::size_t i = 0; i < odds_.log_odds.size(); ++i) {
    if (surfaces_.piece[i] < 0) continue;
    const float found = gathered[static_cast<std::size_t>(surfaces_.piece[i])];
    const float log_odds = static_cast<float>(options_.decay) * odds_.log_odds[i] + found;
    odds_.log_odds[i] = std::clamp(log_odds, -most, most);
    if (log_odds > options_.moves_above) odds_.moves[i] = 1;
    if (log_odds < options_.still_below) odds_.moves[i] = 0;
    // Whoever has sat for long gets up at once: the odds follow within frames.
    const bool uneasy = log_odds > kUneasy || found > kStartled;
    odds_.calm_s[i] = uneasy ? 0.0F : odds_.calm_s[i] + step_s;
  }
}

void MotionEvidence::move_on(const SE3& T_origin_now) {
  if (!seen_.empty()) {
    T_now_last_ = T_origin_now.inverse() * T_origin_last_;
    interval_s_ = seconds_between(last_stamp_, now_->stamp);
  }
  T_origin_last_ = T_origin_now;
  last_stamp_ = now_->stamp;
}

void MotionEvidence::remember() {
  move_on(now_->T_origin_camera);
  // Little is known yet: the more witnesses, the better.
  const int more = frames_ < kYoung ? 4 : 1;
  now_->features = some_of(*now_->features, odds_, more * options_.features_of_place);
  last_pieces_.reset();
  seen_.push_back(*std::exchange(now_, {}));
  // From the oldest on: one goes whose neighbours are close enough for its age without it.
  const auto age_s = [&](std::size_t i) {
    return seconds_between(seen_[i].stamp, seen_.back().stamp);
  };
  while (age_s(0) > kMemory_s) seen_.pop_front();
  for (std::size_t i = 1; i + 1 < seen_.size();) {
    const bool dense = age_s(i - 1) - age_s(i + 1) < spacing_s(age_s(i));
    if (dense) {
      seen_.erase(seen_.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
}

}  // namespace ydd
