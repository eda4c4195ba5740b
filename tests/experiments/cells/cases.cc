#include "fast/contact/surface_cells.h"
#include "fast/contact/rest_distance.h"
#include "fast/contact/mass_distribution.h"
#include "fast/contact/tool_samples.h"
#include "fast/step/stages.h"
#include "fast/step/step.h"
#include "scene/shape/surface.h"
#include "support/press.h"
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <numbers>
#include <string>
using namespace touchstone; using namespace touchstone::fast; using scene::Vec3;
struct NamedTool { std::string name; scene::Tool tool; std::shared_ptr<const scene::Shape> shape; };
std::vector<NamedTool> tools(double radius_m) {
  scene::Tool capsule, cylinder, box, mesh, fine;
  capsule.shape = scene::ToolShape::capsule; cylinder.shape = scene::ToolShape::cylinder; box.shape = scene::ToolShape::box;
  capsule.radius_m = cylinder.radius_m = radius_m; capsule.length_m = cylinder.length_m = 3.0 * radius_m;
  box.size_m = radius_m * Vec3(2.0, 1.4, 3.0);
  const auto egg = std::make_shared<scene::Ellipsoid>(Vec3::Zero(), radius_m * Vec3(1.0, 0.7, 1.5));
  const auto of = [&](int triangles) { const scene::Surface s = scene::tessellate(*egg, triangles);
    auto made = std::make_shared<scene::TriangleMesh>(); made->points_m = s.points_m; made->triangles = s.triangles; made->convex = true; return made; };
  mesh.shape = fine.shape = scene::ToolShape::mesh; mesh.mesh = of(500); fine.mesh = of(10000);
  return {{"Sphere", test::ball(radius_m), nullptr},{"Capsule", capsule, nullptr},{"Cylinder", cylinder, nullptr},{"Box", box, nullptr},{"Mesh", mesh, egg},{"FineMesh", fine, egg}};
}
struct Out { double force, ax, depth_rel; Vec3 d; int points; double us; };
// independent limit
struct Leaf { Vec3 p_W, p_T, n_T; double area; double dist; Vec3 rn; Spread sp; };
double F_of(const std::vector<Leaf>& leaves, const scene::Shape& body, const Detection& det, const Placement& at, const Vec3& d) {
  const Vec3 d_T = at.R_WT.transpose()*d; double sw=0, swd=0;
  for (const Leaf& l : leaves) {
    const double c = l.n_T.dot(d_T); if (c < 0) continue; const double a = l.area*c; if (!(a>0)) continue;
    const Vec3 r = l.p_T - l.p_T.dot(d_T)*d_T;
    const double w = a*mean_inverse_distance_per_m(r.squaredNorm(), std::sqrt(a/std::numbers::pi));
    sw += w; swd += w*det.exit_distance_m(body, l.p_W, -d);
  }
  return swd/sw;
}
int main(int argc, char** argv) {
  const char* refs = getenv("REFS")?getenv("REFS"):"/tmp/cc/refs.txt"; bool make_refs = argc>1 && !strcmp(argv[1],"refs"); size_t N = argc>2? atoi(argv[2]):6000;
  double thr=0.01;
  std::map<std::string,std::pair<double,double>> known;
  if (!make_refs) { FILE* f=fopen(refs,"r"); char n[200]; double a,b; while (f&&fscanf(f,"%s %lf %lf",n,&a,&b)==3) known[n]={a,b}; }
  FILE* out = make_refs? fopen(refs,"w"):nullptr;
  std::vector<scene::Body> bodies(4);
  bodies[0].shape = scene::BodyShape::box; bodies[0].size_m = Vec3::Constant(0.06);
  bodies[1].shape = scene::BodyShape::sphere; bodies[1].radius_m = 0.03;
  bodies[2].shape = scene::BodyShape::ellipsoid; bodies[2].semi_axes_m = Vec3(0.04, 0.03, 0.025);
  bodies[3].shape = scene::BodyShape::revolution; bodies[3].profile = scene::cylinder_profile(0.03, 0.06, 0.0);
  const char* bn[]={"box","sphere","ellip","rev"}; 
  const Vec3 place[]={Vec3(0,0,1.2),Vec3(0.36,0.6,1.2),Vec3(1.2,0,1.2),Vec3(1.2,1.2,1.2)}; const char* pn[]={"mid","off","edge","corner"};
  int bad=0,n=0; double insn=0; std::map<std::string,int> cls;
  for (int b=0;b<4;++b) for (int pl=0;pl<4;++pl) for (double ratio : {1e-3,1e-2,0.1,0.3,0.5,1.0,3.0,10.0,100.0,1000.0}) for (const NamedTool& t: tools(0.03*ratio)) {
    char name[200]; snprintf(name,200,"%s-%s-%g-%s",bn[b],pn[pl],ratio,t.name.c_str());
    if (argc>3 && !strstr(name,argv[3])) continue;
    scene::Scene scene = test::ball_on_cube(); scene.body=bodies[b]; scene.contact.k3_n_per_m3=0; scene.contact.k1_n_per_m=1; scene.tool=t.tool; scene.tool.radius_m=0.03*ratio; scene.fast.tool_samples=2000; scene.fast.triangles=400;
    FastModel model(scene); if(getenv("PTS")&&!make_refs) model.formulas.cells->points=atoi(getenv("PTS")); if(getenv("RIM")) model.formulas.cells->rim_share=atof(getenv("RIM")); FastState state(model);
    std::shared_ptr<const scene::Shape> ts = t.shape? t.shape : std::shared_ptr<const scene::Shape>(scene::tool_shape(t.tool));
    const double radius_m=0.03*ratio, depth_m=std::min(0.002,0.3*radius_m);
    const scene::Bounds around = model.body->bounds();
    scene::SurfaceQuery at = model.body->query(0.5*(around.lower_m+around.upper_m)+0.5*(around.upper_m-around.lower_m).cwiseProduct(place[pl]));
    double low_m=0, high_m=6*radius_m;
    for (int k=0;k<100;++k) { const double h=0.5*(low_m+high_m); (ts->signed_distance_m(Vec3(-h*at.normal))<0? low_m:high_m)=h; }
    if (t.shape) { low_m=0; const Vec3 dir=-at.normal; for (auto& tr: t.tool.mesh->triangles) { const Vec3 a=t.tool.mesh->points_m.col(tr[0]),u=t.tool.mesh->points_m.col(tr[1])-a,v=t.tool.mesh->points_m.col(tr[2])-a; const Vec3 h=dir.cross(v); const double det=u.dot(h); if(std::abs(det)<1e-300) continue; const Vec3 s=-a; const double uu=s.dot(h)/det; if(uu<-1e-9||uu>1+1e-9) continue; const Vec3 q=s.cross(u); const double vv=dir.dot(q)/det; if(vv<-1e-9||uu+vv>1+1e-9) continue; low_m=std::max(low_m,v.dot(q)/det); } }
    scene::Pose pose;
    for (int k=-3;k<=20;++k) { pose={at.point_m+(low_m-depth_m*k/20.0)*at.normal,Eigen::Quaterniond::Identity()}; if(!make_refs) step_force(model,pose,state); else if(k==20) step_force(model,pose,state); }
    if (make_refs) {
      const Placement P = placement(pose);
      double est[2];
      for (int level=0; level<2; ++level) {
        const size_t want = level? 4*N : N; 
        std::vector<SurfaceCell> now(model.tool.cell.begin(),model.tool.cell.end()), near; std::vector<Leaf> leaves;
        auto look=[&](const SurfaceCell& c, Leaf& l){ l.p_T=c.center_T_m; l.p_W=P.R_WT*l.p_T+P.origin_W_m; l.n_T=c.normal_T; l.area=c.area_m2; l.sp=c.spread_m;
          const scene::SurfaceQuery q = model.body->query(l.p_W); l.dist=q.signed_distance_m; l.rn=q.normal; };
        for(int round=0; round<60; ++round) {
          near.clear(); size_t inside=0; bool groups=false;
          for (auto& c: now) { Leaf l; look(c,l); if (l.dist<c.radius_m) { near.push_back(c); if(c.group>=0) groups=true; if (l.dist<0 && c.group<0) ++inside; } }
          if (getenv("VERB")) fprintf(stderr,"round %d near %zu inside %zu\n",round,near.size(),inside);
          if (near.empty()) break;
          if (inside>=want && (!groups || inside>3*want)) break;
          if (near.size()>40*want) break;
          now.clear(); for(auto&c:near){ auto h=halves(c,model.tool.groups); now.push_back(h[0]); now.push_back(h[1]); }
        }
        Vec3 ns=Vec3::Zero();
        // rim refinement
        std::vector<std::pair<SurfaceCell,int>> st; for(auto&c:near) st.push_back({c,0});
        while(!st.empty()) { auto [c,dp]=st.back(); st.pop_back(); Leaf l; look(c,l); if(!(l.dist<c.radius_m)) continue;
          bool rim = l.dist>-c.radius_m;
          if ((rim&&dp<4) || (c.group>=0&&dp<40)) { auto h=halves(c,model.tool.groups); st.push_back({h[0],dp+1}); st.push_back({h[1],dp+1}); continue; }
          if (rim) { CutPolygon pg({c.corner_m.data(),(size_t)c.corners}); const Vec3 n_T=P.R_WT.transpose()*l.rn; pg.keep_below(n_T,l.dist); auto m=pg.moments(); const double share=c.polygon_m2>0? std::min(1.0,m.area_m2/c.polygon_m2):0; if(!(share>0)) continue;
            if (share<1) { l.area*=share; l.p_T+=m.center_m-c.polygon_center_m; l.p_W=P.R_WT*l.p_T+P.origin_W_m; const scene::SurfaceQuery q=model.body->query(l.p_W); l.dist=q.signed_distance_m; l.rn=q.normal; } }
          if (!(l.dist<0)) continue;
          if(t.name=="Sphere") ns+=-l.area*(l.dist*l.rn.dot(l.n_T)+l.dist*l.dist/radius_m)*l.n_T; else ns+=l.area*-l.dist*l.rn; leaves.push_back(l); }
        const Vec3 d=-ns.normalized();
        est[level]=leaves.empty()?0:F_of(leaves,*model.body,model.detection,P,d);
        if (getenv("VERB")) {double A2=0; for(auto&l:leaves) A2+=l.area*std::max(0.0,l.n_T.dot(P.R_WT.transpose()*d)); fprintf(stderr,"A %.6g ",A2);} fprintf(stderr,"leaves %zu d %.9f %.9f %.9f F %.9g\n",leaves.size(),d.x(),d.y(),d.z(),est[level]);
      }
      fprintf(out,"%s %.12g %.3g\n",name,(4*est[1]-est[0])/3,(est[1]-est[0])/3/est[1]); fflush(out);
      continue;
    }
    const double F=total_force_n(state).norm(); auto [ref,ref_err]=known[name];
    const double e=F/ref-1; double dm=0,AA=state.regions[0].extent.area_m2; (void)dm; ++n; if(!(std::abs(e)<=thr)) { ++bad; cls[std::string(bn[b])+"-"+pn[pl]]++; }
    const auto& reg=state.regions[0];
    printf("%-30s F %.6g err %9.3f%% ref_err %8.4f%% pts %4d A %.6g d %.5f %.5f %.5f %s\n",name,F,100*e,100*ref_err,reg.points.count,AA,reg.d.x(),reg.d.y(),reg.d.z(), std::abs(e)<=thr?"":"BAD");
  }
  if(!make_refs) { printf("bad %d of %d\n",bad,n); for(auto&[k,v]:cls) printf("  %s %d\n",k.c_str(),v); }
}
