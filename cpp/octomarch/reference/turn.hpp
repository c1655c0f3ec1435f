// Twists and bends: turns that change from point to point. Vectors come before it; domain.hpp has it among the operators
// over points.
#pragma once

#include <cmath>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/jet.hpp"

namespace octomarch::reference {

/// A kTwist or kBend at a point. First p is drawn straight towards an axis until it is within `radius` of it; then the
/// plane (u, v) is turned by rate times coordinate `along`, which for a twist is that of the axis, for a bend u.
template <class T>
class Turn {
 public:
  Turn(const Node& node, const Vector<T>& p) : rate_(T(node.parameter(0))), radius_(T(node.parameter(1))) {
    const int axis = node.kind() == NodeKind::kBend ? 2 : static_cast<int>(node.parameter(2));
    along_ = node.kind() == NodeKind::kBend ? 0 : axis;
    u_ = axis == 0 ? 1 : 0;
    v_ = axis == 2 ? 1 : 2;
    across_ = p;
    across_[axis] = T(0);
    distance_ = glm::length(across_);
    drawn_ = p;
    if (distance_ > radius_) {
      drawn_[u_] *= radius_ / distance_;
      drawn_[v_] *= radius_ / distance_;
    }
    const T angle = rate_ * drawn_[along_];
    sine_ = std::sin(angle);
    cosine_ = std::cos(angle);
  }

  /// Where the child is looked at.
  Vector<T> point() const { return turned(drawn_, sine_); }
  /// What the child is cut to: the cylinder that holds it.
  Jet<T> wall() const { return {distance_ - radius_, direction_of(across_)}; }
  /// The child's gradient as that of the whole.
  Vector<T> gradient(const Vector<T>& child) const {
    const Vector<T> q = point();
    Vector<T> g = turned(child, -sine_);
    g[along_] += rate_ * (child[v_] * q[u_] - child[u_] * q[v_]);
    if (!(distance_ > radius_)) return g;
    const Vector<T> outward = direction_of(across_);
    Vector<T> kept(0);
    kept[u_] = g[u_];
    kept[v_] = g[v_];
    return g - kept + (kept - outward * glm::dot(kept, outward)) * (radius_ / distance_);
  }

  /// The direction of the child's gradient where that of the whole is along `parent`: the inverse of gradient(), but for
  /// lengths, inside the wall.
  Vector<T> child_direction(const Vector<T>& parent) const {
    const Vector<T> q = point();
    Vector<T> g = turned(parent, sine_);
    if (along_ != u_) {
      g[along_] -= rate_ * (g[v_] * q[u_] - g[u_] * q[v_]);
      return direction_of(g);
    }
    // two equations, of u and v, by Cramer's rule
    const T determinant = T(1) - rate_ * drawn_[v_];
    g = parent * determinant;
    g[u_] = cosine_ * parent[u_] - (sine_ + rate_ * q[u_]) * parent[v_];
    g[v_] = sine_ * parent[u_] + (cosine_ - rate_ * q[v_]) * parent[v_];
    return direction_of(determinant < T(0) ? -g : g);
  }

 private:
  Vector<T> turned(const Vector<T>& a, T sine) const {
    Vector<T> result = a;
    result[u_] = cosine_ * a[u_] - sine * a[v_];
    result[v_] = sine * a[u_] + cosine_ * a[v_];
    return result;
  }

  T rate_, radius_;
  int along_, u_, v_;
  Vector<T> across_, drawn_;
  T distance_;
  T sine_, cosine_;
};

}  // namespace octomarch::reference
