// Boost.odeint on the scenes. A line `run METHOD SETTING SECONDS SCENEFILE` on standard input, an answer in JSON on standard output.
//
// METHOD is a method and the way forces are written: `dopri5-plain`, `fehlberg78-rows`, ... `plain` is what one writes first, `rows`
// leaves no branch and no dependence between contacts, so that the compiler makes vectors of it.

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
    // A file of plain numbers: n, duration, times of the peaks, then one row each.
    std::vector<double> inverse_mass, stiffness, overlap, load, velocity, times;
    double duration = 0;
    size_t n = 0;
    mutable std::vector<double> padded, force;

    explicit Problem(const std::string &path) {
        std::ifstream in(path);
        size_t peaks;
        in >> n >> duration >> peaks;
        auto read = [&](std::vector<double> &row, size_t count) {
            row.resize(count);
            for (double &value : row) in >> value;
        };
        read(times, peaks);
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

// From peak to peak and to the end; `advance` takes the state from one time to another.
template <class Advance> std::vector<State> through(const Problem &problem, Advance advance) {
    State y(2 * problem.n, 0.0);
    for (size_t i = 0; i < problem.n; ++i) y[problem.n + i] = problem.velocity[i];
    std::vector<State> states;
    double from = 0;
    for (double to : problem.times) {
        advance(y, from, to);
        states.push_back(y);
        from = to;
    }
    return states;
}

template <class Stepper, bool Rows>
std::vector<State> adaptive(const Problem &problem, double tolerance) {
    auto stepper = odeint::make_controlled(tolerance, tolerance, Stepper());
    double step = 0.01;
    return through(problem, [&](State &y, double from, double to) {
        step = std::min(step, to - from);
        double t = from;
        First<Rows> rates{problem};
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
        }
    });
}

template <class Stepper, bool Rows> std::vector<State> fixed(const Problem &problem, double wanted) {
    return through(problem, [&](State &y, double from, double to) {
        Stepper stepper;
        size_t steps = size_t(std::ceil((to - from) / wanted));
        odeint::integrate_n_steps(stepper, First<Rows>{problem}, y, from, (to - from) / double(steps), steps);
    });
}

// Boost's own second-order steppers work on pairs of positions and velocities.
template <bool Rows> std::vector<State> verlet(const Problem &problem, double wanted) {
    return through(problem, [&](State &y, double from, double to) {
        const size_t n = problem.n;
        odeint::velocity_verlet<State> stepper;
        std::pair<State, State> state{State(y.begin(), y.begin() + n), State(y.begin() + n, y.end())};
        auto force = [&](const State &x, const State &, State &a, double) { Second<Rows>{problem}(x, a); };
        size_t steps = size_t(std::ceil((to - from) / wanted));
        odeint::integrate_n_steps(stepper, force, std::make_pair(boost::ref(state.first), boost::ref(state.second)),
                                  from, (to - from) / double(steps), steps);
        std::copy(state.first.begin(), state.first.end(), y.begin());
        std::copy(state.second.begin(), state.second.end(), y.begin() + n);
    });
}

template <bool Rows> std::vector<State> mclachlan(const Problem &problem, double wanted) {
    return through(problem, [&](State &y, double from, double to) {
        const size_t n = problem.n;
        odeint::symplectic_rkn_sb3a_m4_mclachlan<State> stepper;
        std::pair<State, State> state{State(y.begin(), y.begin() + n), State(y.begin() + n, y.end())};
        size_t steps = size_t(std::ceil((to - from) / wanted));
        odeint::integrate_n_steps(stepper, Second<Rows>{problem},
                                  std::make_pair(boost::ref(state.first), boost::ref(state.second)), from,
                                  (to - from) / double(steps), steps);
        std::copy(state.first.begin(), state.first.end(), y.begin());
        std::copy(state.second.begin(), state.second.end(), y.begin() + n);
    });
}

template <bool Rows>
bool solve(const std::string &method, const Problem &problem, double setting, std::vector<State> &states) {
    using odeint::runge_kutta4;
    if (method == "dopri5") states = adaptive<odeint::runge_kutta_dopri5<State>, Rows>(problem, setting);
    else if (method == "fehlberg78") states = adaptive<odeint::runge_kutta_fehlberg78<State>, Rows>(problem, setting);
    else if (method == "cash-karp54") states = adaptive<odeint::runge_kutta_cash_karp54<State>, Rows>(problem, setting);
    else if (method == "rk4") states = fixed<runge_kutta4<State>, Rows>(problem, setting);
    else if (method == "adams5") states = fixed<odeint::adams_bashforth_moulton<5, State>, Rows>(problem, setting);
    else if (method == "verlet") states = verlet<Rows>(problem, setting);
    else if (method == "mclachlan4") states = mclachlan<Rows>(problem, setting);
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
        const size_t dash = name.rfind('-');
        const std::string method = name.substr(0, dash);
        const bool rows = name.substr(dash + 1) == "rows";
        std::vector<State> states;
        const double start = cpu_time();
        auto once = [&] {
            return rows ? solve<true>(method, problem, setting, states) : solve<false>(method, problem, setting, states);
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
