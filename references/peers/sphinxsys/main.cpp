// One flow or solid by SPHinXsys: reads numbers from standard input, writes what moves at each of the times.
// The scheme is that of the example of the code for this kind of problem: wall-bounded and viscous, periodic
// and viscous, with a free surface, an elastic bar or rings. Lengths are in units of the problem, velocities
// in c0/10, densities in rho0.
#include "sphinxsys.h"
#include <tbb/global_control.h>
#include <cstdio>
#include <ctime>
using namespace SPH;

struct Placed {
    StdVec<Vecd> places, velocities, normals;
    StdVec<Real> volumes;
};

namespace SPH {
class Given;
template <> class ParticleGenerator<BaseParticles, Given> : public ParticleGenerator<BaseParticles> {
    const Placed &placed;

  public:
    ParticleGenerator(SPHBody &body, BaseParticles &particles, const Placed &placed)
        : ParticleGenerator<BaseParticles>(body, particles), placed(placed) {}
    void prepareGeometricData() override {
        for (size_t k = 0; k < placed.places.size(); k++)
            addPositionAndVolumetricMeasure(placed.places[k], placed.volumes[k]);
    }
};
} // namespace SPH

static Real number() {
    double x;
    if (scanf("%lf", &x) != 1) exit(1);
    return x;
}

static Vecd vector() {
    Real x = number();
    return Vecd(x, number());
}

static Placed particles(bool of_wall) {
    Placed placed;
    size_t count = size_t(number());
    for (size_t k = 0; k < count; k++) {
        placed.places.push_back(vector());
        placed.velocities.push_back(vector());
        placed.volumes.push_back(number());
        if (of_wall) placed.normals.push_back(vector().normalized());
    }
    return placed;
}

template <class Body> static void generate(Body &body, const Placed &placed, Real ratio) {
    body.defineAdaptationRatios(ratio);
    body.template generateParticles<BaseParticles, Given>(placed);
    Vecd *velocity = body.getBaseParticles().template registerStateVariableData<Vecd>("Velocity");
    for (size_t k = 0; k < placed.places.size(); k++) velocity[k] = placed.velocities[k];
}

static void rows(BaseParticles &all, size_t count) {
    Vecd *place = all.getVariableDataByName<Vecd>("Position");
    Vecd *velocity = all.getVariableDataByName<Vecd>("Velocity");
    Real *rho = all.getVariableDataByName<Real>("Density");
    for (size_t k = 0; k < count; k++) {
        printf("%.17g %.17g ", place[k][0], place[k][1]);
        printf("%.17g %.17g %.17g\n", velocity[k][0], velocity[k][1], rho[k]);
    }
}

static void frame(Real time, size_t steps, Real seconds, BaseParticles &all, size_t count) {
    printf("frame %.17g %zu %.9g\n", double(time), steps, double(seconds));
    rows(all, count);
}

// A bar whose particles `held` stay where they are.
static void bar(SPHSystem &system, SolidBody &body, Placed placed, const Placed &held, Real ratio, Vecd g,
                const StdVec<Real> &times) {
    size_t count = placed.places.size(), steps = 0;
    placed.places.insert(placed.places.end(), held.places.begin(), held.places.end());
    placed.velocities.insert(placed.velocities.end(), held.velocities.begin(), held.velocities.end());
    placed.volumes.insert(placed.volumes.end(), held.volumes.begin(), held.volumes.end());
    generate(body, placed, ratio);
    InnerRelation inner(body);
    Gravity gravity(g);
    SimpleDynamics<GravityForce<Gravity>> weight(body, gravity);
    InteractionWithUpdate<LinearGradientCorrectionMatrixInner> correction(inner);
    Dynamics1Level<solid_dynamics::Integration1stHalfPK2> first(inner);
    Dynamics1Level<solid_dynamics::Integration2ndHalf> second(inner);
    ReduceDynamics<solid_dynamics::AcousticTimeStep> longest(body);
    system.initializeSystemCellLinkedLists();
    system.initializeSystemConfigurations();
    correction.exec();
    weight.exec();
    BaseParticles &all = body.getBaseParticles();
    Vecd *place = all.getVariableDataByName<Vecd>("Position");
    Vecd *velocity = all.getVariableDataByName<Vecd>("Velocity");
    Real now = 0, seconds = 0;
    for (Real time : times) {
        clock_t begin = clock();
        for (; now < time * (1 - 1e-12); steps++) {
            Real dt = std::min(longest.exec(), time - now);
            first.exec(dt);
            for (size_t k = count; k < placed.places.size(); k++) {
                place[k] = placed.places[k];
                velocity[k] = Vecd::Zero();
            }
            second.exec(dt);
            now += dt;
        }
        seconds += Real(clock() - begin) / CLOCKS_PER_SEC;
        frame(time, steps, seconds, all, count);
    }
}

struct Ring {
    InnerRelation inner;
    SurfaceContactRelation contact;
    InteractionWithUpdate<LinearGradientCorrectionMatrixInner> correction{inner};
    Dynamics1Level<solid_dynamics::Integration1stHalfPK2> first{inner};
    Dynamics1Level<solid_dynamics::Integration2ndHalf> second{inner};
    InteractionDynamics<solid_dynamics::ContactFactorSummation> factor{contact};
    ReduceDynamics<solid_dynamics::AcousticTimeStep> longest;

    Ring(SolidBody &body, SolidBody &other) : inner(body), contact(body, {&other}), longest(body) {}
};

// Two rings, one after the other in `placed`; all of their particles are near a surface.
static void rings(SPHSystem &system, const Placed &placed, Real ratio, Real young, Real poisson,
                  const StdVec<Real> &times) {
    size_t count = placed.places.size() / 2, steps = 0;
    StdVec<Placed> parts(2);
    StdVec<Vecd> centres(2, Vecd::Zero());
    for (size_t k = 0; k < 2 * count; k++) {
        Placed &part = parts[k / count];
        part.places.push_back(placed.places[k]);
        part.velocities.push_back(placed.velocities[k]);
        part.volumes.push_back(placed.volumes[k]);
        centres[k / count] += placed.places[k] / Real(count);
    }
    Real radius = 0; // of the middle line
    for (const Vecd &place : parts[0].places) radius += (place - centres[0]).norm() / Real(count);
    GeometricShapeBall left(centres[0], radius, "Left"), right(centres[1], radius, "Right");
    SolidBody a(system, left), b(system, right);
    SolidBody *bodies[] = {&a, &b};
    for (size_t of : {0, 1}) {
        bodies[of]->defineMatterMaterial<NeoHookeanSolid>(1.0, young, poisson);
        generate(*bodies[of], parts[of], ratio);
    }
    Ring one(a, b), two(b, a), *both[] = {&one, &two};
    InteractionWithUpdate<solid_dynamics::ContactForce> on_one(one.contact), on_two(two.contact);
    system.initializeSystemCellLinkedLists();
    system.initializeSystemConfigurations();
    for (Ring *ring : both) ring->correction.exec();
    Real now = 0, seconds = 0;
    for (Real time : times) {
        clock_t begin = clock();
        for (; now < time * (1 - 1e-12); steps++) {
            for (Ring *ring : both) ring->factor.exec();
            on_one.exec();
            on_two.exec();
            Real dt = std::min({one.longest.exec(), two.longest.exec(), time - now});
            for (Ring *ring : both) ring->first.exec(dt);
            for (Ring *ring : both) ring->second.exec(dt);
            for (SolidBody *body : bodies) body->updateCellLinkedList();
            for (Ring *ring : both) ring->contact.updateConfiguration();
            now += dt;
        }
        seconds += Real(clock() - begin) / CLOCKS_PER_SEC;
        frame(time, steps, seconds, a.getBaseParticles(), count);
        rows(b.getBaseParticles(), count);
    }
}

struct Flow {
    FluidBody &fluid;
    InnerRelation &inner;
    StdVec<Real> times;
    std::function<void()> begin, neighbours;
};

// Called with `::`, for a search by arguments would instantiate classes that are tags only.
template <class Advection, class First, class Second>
static void run(Flow &flow, First &pressure, Second &density, std::function<void()> prior) {
    ReduceDynamics<Advection> longest(flow.fluid, 1.0);
    ReduceDynamics<fluid_dynamics::AcousticTimeStep> shorter(flow.fluid);
    flow.begin();
    Real now = 0, seconds = 0;
    size_t steps = 0;
    for (Real time : flow.times) {
        clock_t begin = clock();
        while (now < time * (1 - 1e-12)) {
            Real advection = std::min(longest.exec(), time - now), passed = 0;
            prior();
            while (passed < advection * (1 - 1e-12)) {
                Real dt = std::min(shorter.exec(), advection - passed);
                pressure.exec(dt);
                density.exec(dt);
                passed += dt;
                steps++;
            }
            now += passed;
            flow.neighbours();
        }
        now = time;
        seconds += Real(clock() - begin) / CLOCKS_PER_SEC;
        BaseParticles &all = flow.fluid.getBaseParticles();
        frame(time, steps, seconds, all, all.TotalRealParticles());
    }
}

static void vortices(Flow &flow) {
    InnerRelation &inner = flow.inner;
    Dynamics1Level<fluid_dynamics::Integration1stHalfInnerRiemann> pressure(inner);
    Dynamics1Level<fluid_dynamics::Integration2ndHalfInnerNoRiemann> density(inner);
    InteractionWithUpdate<fluid_dynamics::DensitySummationInner> summation(inner);
    InteractionWithUpdate<fluid_dynamics::ViscousForceInner> viscous(inner);
    InteractionWithUpdate<fluid_dynamics::TransportVelocityCorrectionInner<TruncatedLinear, AllParticles>>
        transport(inner);
    ::run<fluid_dynamics::AdvectionViscousTimeStep>(flow, pressure, density, [&] {
        summation.exec();
        viscous.exec();
        transport.exec();
    });
}

static void channel(Flow &flow, ContactRelation &walls) {
    InnerRelation &inner = flow.inner;
    InteractionWithUpdate<LinearGradientCorrectionMatrixComplex> correction(inner, walls);
    Dynamics1Level<fluid_dynamics::Integration1stHalfCorrectionWithWallRiemann> pressure(inner, walls);
    Dynamics1Level<fluid_dynamics::Integration2ndHalfWithWallNoRiemann> density(inner, walls);
    InteractionWithUpdate<fluid_dynamics::DensitySummationComplex> summation(inner, walls);
    InteractionWithUpdate<fluid_dynamics::ViscousForceWithWallCorrection> viscous(inner, walls);
    InteractionWithUpdate<fluid_dynamics::TransportVelocityCorrectionCorrectedComplex<AllParticles>>
        transport(inner, walls);
    ::run<fluid_dynamics::AdvectionViscousTimeStep>(flow, pressure, density, [&] {
        summation.exec();
        correction.exec();
        viscous.exec();
        transport.exec();
    });
}

static void dam_break(Flow &flow, ContactRelation &walls) {
    Dynamics1Level<fluid_dynamics::Integration1stHalfWithWallRiemann> pressure(flow.inner, walls);
    Dynamics1Level<fluid_dynamics::Integration2ndHalfWithWallRiemann> density(flow.inner, walls);
    InteractionWithUpdate<fluid_dynamics::DensitySummationComplexFreeSurface> summation(flow.inner, walls);
    ::run<fluid_dynamics::AdvectionTimeStep>(flow, pressure, density, [&] { summation.exec(); });
}

int main(int, char **) {
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    Vecd low = vector(), high = vector(), box_low = vector(), box_high = vector(), g = vector();
    bool periodic[2] = {number() > 0, number() > 0};
    Real dx = number(), support = number(), nu = number(), young = number(), poisson = number();
    StdVec<Real> times;
    for (size_t count = size_t(number()); count > 0; count--) times.push_back(number());
    Placed water = particles(false), solid = particles(true);

    SPHSystem system(BoundingBoxd(box_low, box_high), dx);
    GeometricShapeBox shape(Transform(0.5 * (low + high)), 0.5 * (high - low), "Fluid");
    if (young > 0 && solid.places.empty()) {
        rings(system, water, 0.5 * support / dx, young, poisson, times);
        return 0;
    }
    if (young > 0) {
        SolidBody body(system, shape);
        body.defineMatterMaterial<SaintVenantKirchhoffSolid>(1.0, young, poisson);
        bar(system, body, water, solid, 0.5 * support / dx, g, times);
        return 0;
    }
    FluidBody fluid(system, shape);
    fluid.defineMatterMaterial<WeaklyCompressibleFluid>(1.0, 10.0);
    if (nu > 0) fluid.addMaterialProperty<Viscosity>(nu);
    generate(fluid, water, 0.5 * support / dx);
    InnerRelation inner(fluid);
    Gravity gravity(g);
    SimpleDynamics<GravityForce<Gravity>> weight(fluid, gravity);
    PeriodicAlongAxis along_x(BoundingBoxd(low, high), xAxis), along_y(BoundingBoxd(low, high), yAxis);
    PeriodicConditionUsingCellLinkedList in_x(fluid, along_x), in_y(fluid, along_y);
    auto copies = [&] {
        if (periodic[0]) in_x.update_cell_linked_list_.exec();
        if (periodic[1]) in_y.update_cell_linked_list_.exec();
    };
    SPHRelation *neighbours = &inner;
    Flow flow{fluid, inner, times, [&] {
        system.initializeSystemCellLinkedLists();
        copies();
        system.initializeSystemConfigurations();
        weight.exec();
    }, [&] {
        if (periodic[0]) in_x.bounding_.exec();
        if (periodic[1]) in_y.bounding_.exec();
        fluid.updateCellLinkedList();
        copies();
        neighbours->updateConfiguration();
    }};
    if (solid.places.empty()) {
        vortices(flow);
        return 0;
    }
    GeometricShapeBox outer(Transform(0.5 * (box_low + box_high)), 0.5 * (box_high - box_low), "Wall");
    SolidBody wall(system, outer);
    wall.defineMatterMaterial<Solid>();
    generate(wall, solid, 0.5 * support / dx);
    Vecd *normal = wall.getBaseParticles().registerStateVariableData<Vecd>("NormalDirection");
    for (size_t k = 0; k < solid.places.size(); k++) normal[k] = solid.normals[k];
    ContactRelation walls(fluid, {&wall});
    ComplexRelation both(inner, walls);
    neighbours = &both;
    nu > 0 ? channel(flow, walls) : dam_break(flow, walls);
    return 0;
}
