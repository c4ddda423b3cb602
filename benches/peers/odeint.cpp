// Boost.odeint on the scenes. A line `run METHOD SETTING SECONDS SCENEFILE` on standard input, an answer in JSON on standard output.
//
// METHOD is a method and the way forces are written: `dopri5-plain`, `fehlberg78-rows`, ... `plain` is what one writes first, `rows`
// leaves no branch and no dependence between contacts, so that the compiler makes vectors of it. With `+samples` behind it the forces in the
// bodies are sampled all along, as a recording has them: Boost has no dense output for most of these methods, so each step is joined by
// quintics as one would write it.

#include <boost/numeric/odeint.hpp>
#include <boost/numeric/odeint/stepper/symplectic_rkn_sb3a_m4_mclachlan.hpp>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace odeint = boost::numeric::odeint;
using State = std::vector<double>;

struct Problem {
    // A file of plain numbers: n, duration, how many peaks and samples, times and bodies of the peaks, then one row each.
    std::vector<double> inverse_mass, stiffness, overlap, load, velocity, times;
    std::vector<size_t> bodies;
    double duration = 0;
    size_t n = 0, samples = 0;
    mutable std::vector<double> padded, force;

    explicit Problem(const std::string &path) {
        std::ifstream in(path);
        size_t peaks;
        in >> n >> duration >> peaks >> samples;
        auto read = [&](std::vector<double> &row, size_t count) {
            row.resize(count);
            for (double &value : row) in >> value;
        };
        read(times, peaks);
        bodies.resize(peaks);
        for (size_t &body : bodies) in >> body;
        read(inverse_mass, n);
        read(stiffness, n + 1);
        read(overlap, n + 1);
        read(load, n);
        read(velocity, n);
        times.push_back(duration);
        padded.assign(n + 2, 0.0);
        force.assign(n + 1, 0.0);
    }

    void plain(const double *x, double *a) const {
        auto contact = [&](size_t j, double change) {
            double closed = overlap[j] + change;
            return closed > 0 ? stiffness[j] * closed * std::sqrt(closed) : 0.0;
        };
        double above = contact(0, -x[0]);
        for (size_t i = 0; i < n; ++i) {
            double below = contact(i + 1, i + 1 < n ? x[i] - x[i + 1] : x[i]);
            a[i] = (above - below) * inverse_mass[i] + load[i];
            above = below;
        }
    }

    void rows(const double *__restrict x, double *__restrict a) const {
        double *__restrict p = padded.data();
        double *__restrict f = force.data();
        const double *__restrict k = stiffness.data();
        const double *__restrict d = overlap.data();
        const double *__restrict w = inverse_mass.data();
        const double *__restrict g = load.data();
        const size_t bodies = n;
        for (size_t i = 0; i < bodies; ++i) p[i + 1] = x[i];
        for (size_t j = 0; j <= bodies; ++j) {
            double closed = d[j] + p[j] - p[j + 1];
            closed = closed > 0 ? closed : 0;
            f[j] = k[j] * closed * std::sqrt(closed);
        }
        for (size_t i = 0; i < bodies; ++i) a[i] = (f[i] - f[i + 1]) * w[i] + g[i];
    }
};

template <bool Rows> struct First {
    const Problem &problem;
    void operator()(const State &y, State &dy, double) const {
        const size_t n = problem.n;
        for (size_t i = 0; i < n; ++i) dy[i] = y[n + i];
        if (Rows) problem.rows(y.data(), dy.data() + n);
        else problem.plain(y.data(), dy.data() + n);
    }
};

template <bool Rows> struct Second {
    const Problem &problem;
    void operator()(const State &x, State &a) const {
        if (Rows) problem.rows(x.data(), a.data());
        else problem.plain(x.data(), a.data());
    }
};

// Samples the force in a body, evenly spaced in time, while somebody steps.
class Sampler {
    const Problem &problem;
    size_t body;
    double interval;
    // Overlaps of the contacts above and below, their rates and those' rates where the last step has ended, and when that was.
    double ends[2][3] = {}, time = 0;
    size_t taken = 0;

    double contact(const double *x, size_t j) const {
        double closed = problem.overlap[j] + x[j - 1] - x[j];
        return closed > 0 ? problem.stiffness[j] * closed * std::sqrt(closed) : 0.0;
    }

  public:
    std::vector<double> forces;

    Sampler(const Problem &problem, size_t body)
        : problem(problem), body(body), interval(problem.duration / double(problem.samples)), forces(problem.samples + 1) {}

    // A step has ended at `t`, or begins there if it is the first.
    void see(const double *x, const double *v, double t) {
        double force[4], a[3], now[2][3];
        for (size_t k = 0; k < 4; ++k) force[k] = contact(x, body - 1 + k);
        for (size_t k = 0; k < 3; ++k) {
            size_t i = body - 1 + k;
            a[k] = (force[k] - force[k + 1]) * problem.inverse_mass[i] + problem.load[i];
        }
        for (size_t k = 0; k < 2; ++k) {
            size_t i = body - 1 + k;
            now[k][0] = problem.overlap[i + 1] + x[i] - x[i + 1];
            now[k][1] = v[i] - v[i + 1];
            now[k][2] = a[k] - a[k + 1];
        }
        if (t > time) step(now, t);
        for (size_t k = 0; k < 2; ++k)
            for (size_t m = 0; m < 3; ++m) ends[k][m] = now[k][m];
        time = t;
    }

  private:
    void step(const double now[2][3], double t) {
        const double h = t - time;
        double c[2][6];
        for (size_t k = 0; k < 2; ++k) {
            const double w0 = h * ends[k][1], g0 = h * h * ends[k][2], w1 = h * now[k][1], g1 = h * h * now[k][2];
            const double p = now[k][0] - ends[k][0] - w0 - 0.5 * g0, q = w1 - w0 - g0, r = 0.5 * (g1 - g0);
            c[k][0] = ends[k][0], c[k][1] = w0, c[k][2] = 0.5 * g0;
            c[k][3] = 10 * p - 4 * q + r, c[k][4] = 7 * q - 15 * p - 2 * r, c[k][5] = 6 * p - 3 * q + r;
        }
        const double above = 0.5 * problem.stiffness[body], below = 0.5 * problem.stiffness[body + 1];
        const double first = time / h, per = interval / h;
        size_t until = std::min(forces.size(), size_t(t / interval) + 1);
        double *__restrict out = forces.data();
        // Without a branch, so that the compiler makes vectors of it.
        for (size_t i = taken; i < until; ++i) {
            const double s = double(int(i)) * per - first;
            double u = ((((c[0][5] * s + c[0][4]) * s + c[0][3]) * s + c[0][2]) * s + c[0][1]) * s + c[0][0];
            double d = ((((c[1][5] * s + c[1][4]) * s + c[1][3]) * s + c[1][2]) * s + c[1][1]) * s + c[1][0];
            u = u > 0 ? u : 0;
            d = d > 0 ? d : 0;
            out[i] = above * u * std::sqrt(u) + below * d * std::sqrt(d);
        }
        taken = std::max(taken, until);
    }
};

// Those that a run goes by; none where nothing is recorded.
using Samplers = std::vector<Sampler>;

// From peak to peak and to the end, or at once where samples are taken; `advance` takes the state from one time to another.
template <class Advance> std::vector<State> through(const Problem &problem, const Samplers &samplers, Advance advance) {
    State y(2 * problem.n, 0.0);
    for (size_t i = 0; i < problem.n; ++i) y[problem.n + i] = problem.velocity[i];
    std::vector<State> states;
    double from = 0;
    for (double to : problem.times) {
        if (!samplers.empty()) to = problem.duration;
        if (to <= from) break;
        advance(y, from, to);
        states.push_back(y);
        from = to;
    }
    return states;
}

template <class Stepper, bool Rows>
std::vector<State> adaptive(const Problem &problem, Samplers &samplers, double tolerance) {
    auto stepper = odeint::make_controlled(tolerance, tolerance, Stepper());
    double step = 0.01;
    return through(problem, samplers, [&](State &y, double from, double to) {
        step = std::min(step, to - from);
        double t = from;
        First<Rows> rates{problem};
        for (Sampler &sampler : samplers) sampler.see(y.data(), y.data() + problem.n, t);
        for (size_t attempts = 0; t < to; ++attempts) {
            // A tolerance out of reach, or a state that is lost: the answer is a state that is no number.
            if (attempts > 200000 || !std::isfinite(y[0])) {
                y[0] = NAN;
                break;
            }
            double wanted = step;
            if (t + step * (1 + 1e-12) >= to) step = to - t;
            bool cut = step < wanted;
            if (to - t < 1e-13 * to) break;
            auto result = stepper.try_step(rates, y, t, step);
            if (cut && result == odeint::success) step = wanted;
            if (result == odeint::success)
                for (Sampler &sampler : samplers) sampler.see(y.data(), y.data() + problem.n, t);
        }
    });
}

template <class Stepper, bool Rows> std::vector<State> fixed(const Problem &problem, Samplers &samplers, double wanted) {
    return through(problem, samplers, [&](State &y, double from, double to) {
        Stepper stepper;
        size_t steps = size_t(std::ceil((to - from) / wanted));
        auto see = [&](const State &now, double t) {
            for (Sampler &sampler : samplers) sampler.see(now.data(), now.data() + problem.n, t);
        };
        odeint::integrate_n_steps(stepper, First<Rows>{problem}, y, from, (to - from) / double(steps), steps, see);
    });
}

// Boost's own second-order steppers work on pairs of positions and velocities.
template <bool Rows> std::vector<State> verlet(const Problem &problem, Samplers &samplers, double wanted) {
    return through(problem, samplers, [&](State &y, double from, double to) {
        const size_t n = problem.n;
        odeint::velocity_verlet<State> stepper;
        std::pair<State, State> state{State(y.begin(), y.begin() + n), State(y.begin() + n, y.end())};
        auto force = [&](const State &x, const State &, State &a, double) { Second<Rows>{problem}(x, a); };
        size_t steps = size_t(std::ceil((to - from) / wanted));
        auto see = [&](const auto &, double t) {
            for (Sampler &sampler : samplers) sampler.see(state.first.data(), state.second.data(), t);
        };
        odeint::integrate_n_steps(stepper, force, std::make_pair(boost::ref(state.first), boost::ref(state.second)),
                                  from, (to - from) / double(steps), steps, see);
        std::copy(state.first.begin(), state.first.end(), y.begin());
        std::copy(state.second.begin(), state.second.end(), y.begin() + n);
    });
}

template <bool Rows> std::vector<State> mclachlan(const Problem &problem, Samplers &samplers, double wanted) {
    return through(problem, samplers, [&](State &y, double from, double to) {
        const size_t n = problem.n;
        odeint::symplectic_rkn_sb3a_m4_mclachlan<State> stepper;
        std::pair<State, State> state{State(y.begin(), y.begin() + n), State(y.begin() + n, y.end())};
        size_t steps = size_t(std::ceil((to - from) / wanted));
        auto see = [&](const auto &, double t) {
            for (Sampler &sampler : samplers) sampler.see(state.first.data(), state.second.data(), t);
        };
        odeint::integrate_n_steps(stepper, Second<Rows>{problem},
                                  std::make_pair(boost::ref(state.first), boost::ref(state.second)), from,
                                  (to - from) / double(steps), steps, see);
        std::copy(state.first.begin(), state.first.end(), y.begin());
        std::copy(state.second.begin(), state.second.end(), y.begin() + n);
    });
}

template <bool Rows>
bool solve(const std::string &method, const Problem &problem, double setting, Samplers samplers, std::vector<State> &states) {
    using odeint::runge_kutta4;
    if (method == "dopri5") states = adaptive<odeint::runge_kutta_dopri5<State>, Rows>(problem, samplers, setting);
    else if (method == "fehlberg78") states = adaptive<odeint::runge_kutta_fehlberg78<State>, Rows>(problem, samplers, setting);
    else if (method == "cash-karp54") states = adaptive<odeint::runge_kutta_cash_karp54<State>, Rows>(problem, samplers, setting);
    else if (method == "rk4") states = fixed<runge_kutta4<State>, Rows>(problem, samplers, setting);
    else if (method == "adams5") states = fixed<odeint::adams_bashforth_moulton<5, State>, Rows>(problem, samplers, setting);
    else if (method == "verlet") states = verlet<Rows>(problem, samplers, setting);
    else if (method == "mclachlan4") states = mclachlan<Rows>(problem, samplers, setting);
    else return false;
    return true;
}

static double cpu_time() {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

int main() {
    std::map<std::string, Problem> problems;
    std::string line;
    while (std::getline(std::cin, line)) {
        std::istringstream words(line);
        std::string run, name, path;
        double setting = 0, seconds = 0;
        words >> run >> name >> setting >> seconds >> path;
        const Problem &problem = problems.try_emplace(path, path).first->second;
        Samplers samplers;
        if (const size_t plus = name.find('+'); plus != std::string::npos) {
            for (size_t body : problem.bodies) samplers.emplace_back(problem, body);
            name.resize(plus);
        }
        const size_t dash = name.rfind('-');
        const std::string method = name.substr(0, dash);
        const bool rows = name.substr(dash + 1) == "rows";
        std::vector<State> states;
        const double start = cpu_time();
        auto once = [&] {
            return rows ? solve<true>(method, problem, setting, samplers, states)
                        : solve<false>(method, problem, setting, samplers, states);
        };
        if (!once()) {
            std::cout << "{\"failed\": \"found no such method\"}" << std::endl;
            continue;
        }
        const double first = cpu_time() - start;
        states.pop_back();
        std::ostringstream answer;
        answer.precision(17);
        for (size_t s = 0; s < states.size(); ++s) {
            answer << (s ? ", [" : "[");
            bool lost = false;
            for (double value : states[s]) lost |= !std::isfinite(value);
            if (!lost)
                for (size_t i = 0; i < states[s].size(); ++i) answer << (i ? ", " : "") << states[s][i];
            answer << "]";
        }
        double spent = first, calls = 1;
        if (seconds > 0) {
            // The first solution has warmed the caches.
            const double again = cpu_time();
            for (calls = 0, spent = 0; spent < seconds; ++calls, spent = cpu_time() - again) once();
        }
        std::printf("{\"cpu_s\": %.9e, \"states\": [%s]}\n", spent / calls, answer.str().c_str());
        std::fflush(stdout);
    }
}
