// Reference for the golden tests, independent of the program under test: the table scenes in quadruple precision.
//
// Taylor series of order 32 in __float128 with explicit contact flags. Closings are found by root search and restarted in
// s = sqrt(t - t0), in which overlap^1.5 is smooth; openings are approached by error-controlled steps. Tolerance 1e-22 a step.
// Against order 40 at 1e-26 the states differ by at most 1.5e-23 m and 6.7e-19 m/s, against a Gragg-Bulirsch-Stoer
// extrapolation without events by 6.8e-22 m and 4.7e-17 m/s.
//
//   c++ -O2 quad.cpp -lquadmath -o quad && ./quad 1 0.00061 0.44
#include <quadmath.h>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <cmath>
#include <vector>
#include <ctime>
typedef __float128 Q;
const int NB=39; const int MAXN=64;
static int N=32; static Q tolv=1e-22Q, tolu=1e-28Q;
static Q m[NB],A[NB],ov[NB],ext[NB]; // contact j (0..38) between body j-1.. : contact index c=j-1: between body c and c+1 (c=38 wall)
static Q u[NB],v[NB]; static bool closed_[NB];
static Q cu[NB][MAXN],cv[NB][MAXN],cd[NB][MAXN],cw[NB][MAXN],cf[NB][MAXN];
static Q inv[MAXN];
static long nstep=0,nopen=0,nclose=0; static Q vminclose=1e9Q;
static long nsteps_s=0; static bool verbose=false;
static Q pw(const Q*d,Q*w,int k){ // w=d^1.5 recurrence coefficient k
  if(k==0) return d[0]*sqrtq(d[0]);
  Q s=0; for(int j=1;j<=k;j++) s+=(Q)(2.5*j-k)*d[j]*w[k-j]; return s*inv[k]/d[0];}
// build series; sc = index of contact just closing (s-mode) or -1 (t-mode)
static void build(int sc){
  static Q ce[MAXN],ceW[MAXN];
  for(int i=0;i<NB;i++){cu[i][0]=u[i];cv[i][0]=v[i];}
  for(int k=0;k<=N;k++){
    if(k>0) for(int i=0;i<NB;i++){
      if(sc<0){ cu[i][k]=cv[i][k-1]*inv[k]; cv[i][k]=cf[i][k-1]*inv[k]; }
      else { cu[i][k]= k>=2? 2*cv[i][k-2]*inv[k]:0; cv[i][k]= k>=2? 2*cf[i][k-2]*inv[k]:0; }
    }
    for(int c=0;c<NB;c++){
      Q d=cu[c][k]-(c+1<NB?cu[c+1][k]:(Q)0); if(k==0) d+=ov[c];
      if(c==sc && k==0) d=0;
      cd[c][k]=d;
      if(!closed_[c]){cw[c][k]=0;continue;}
      if(c==sc){ // d=s^2 e, w=s^3 e^1.5
        if(k>=2) ce[k-2]=d;
        if(k<3) cw[c][k]=0; else { int j=k-3; ceW[j]=pw(ce,ceW,j); cw[c][k]=A[c]*ceW[j]; }
      } else { // cw holds A*d^1.5
        if(k==0) cw[c][0]=A[c]*d*sqrtq(d); else cw[c][k]=pw(cd[c],cw[c],k);
      }
    }
    for(int i=0;i<NB;i++){ Q f=(i>0?cw[i-1][k]:(Q)0)-cw[i][k]; if(k==0) f+=ext[i]; cf[i][k]=f/m[i]; }
  }
}
static Q ev(const Q*c,Q x){Q s=c[N];for(int k=N-1;k>=0;k--)s=s*x+c[k];return s;}
static Q dev(const Q*c,Q x){Q s=N*c[N];for(int k=N-1;k>=1;k--)s=s*x+(Q)k*c[k];return s;}
static Q radius(){
  Q h=1e9Q;
  for(int q=0;q<2;q++){int k=N-q; Q a=0,b=0; for(int i=0;i<NB;i++){a=fmaxq(a,fabsq(cv[i][k]));b=fmaxq(b,fabsq(cu[i][k]));}
    Q r=fmaxq(a/tolv,b/tolu); if(r>0) h=fminq(h,expq(-logq(r)/k)); }
  return h;
}
// earliest upward zero in (0,h] of open contact c; returns -1 if none
static Q upzero(const Q*c,Q h,bool strict){
  const int S=12; Q xa=0,fa=c[0],ga=dev(c,0);
  for(int i=1;i<=S;i++){
    Q xb=h*i/S, fb=ev(c,xb), gb=dev(c,xb);
    Q lo=xa,hi=xb,flo=fa; bool cand=false;
    if(fa<0&&fb>=0) cand=true;
    else if(fb<0&&ga>0&&gb<0){ // local max inside
      Q l=xa,r=xb; for(int it=0;it<110;it++){Q mm=(l+r)/2; if(dev(c,mm)>0)l=mm;else r=mm; if(ev(c,mm)>=0){hi=mm;lo=xa;cand=(fa<0);break;}}
    } else if(fa>=0&&fb>=0&&gb>0&&i>0){ // just opened with d>=0 tiny then re-closing
      fprintf(stderr,"warn: open contact nonneg %g %g\n",(double)fa,(double)fb);
    }
    if(cand){
      for(int it=0;it<20;it++){Q mm=(lo+hi)/2; if(ev(c,mm)>=0)hi=mm;else lo=mm;}
      Q x=hi; for(int it=0;it<12;it++){Q dx=ev(c,x)/dev(c,x);x-=dx; if(x<lo)x=lo; if(fabsq(dx)<1e-33Q*h)break;}
      return x;
    }
    xa=xb;fa=fb;ga=gb;
  }
  return -1;
}
static Q integrate(Q t,Q tend,int&sc){
  while(t<tend){
    build(sc);
    Q h=radius(); bool last=false; Q hmax= sc<0? tend-t: sqrtq(tend-t);
    if(h>=hmax){h=hmax;last=true;}
    int ec=-1; 
    for(int c=0;c<NB;c++) if(!closed_[c]){ Q x=upzero(cd[c],h,true); if(x>=0){h=x;ec=c;last=false;} }
    if(sc>=0) nsteps_s++;
    for(int i=0;i<NB;i++){Q a=ev(cu[i],h),b=ev(cv[i],h);u[i]=a;v[i]=b;}
    if(last)t=tend; else t+= sc<0?h:h*h;
    nstep++;
    sc=-1;
    for(int c=0;c<NB;c++) if(closed_[c]){Q d=u[c]-(c+1<NB?u[c+1]:(Q)0)+ov[c]; if(d<=0){closed_[c]=false;nopen++;
        if(verbose)fprintf(stderr,"t=%.12e open %d d=%g h=%g\n",(double)t,c+1,(double)d,(double)h);}}
    if(ec>=0){ closed_[ec]=true; sc=ec; nclose++; Q vc=v[ec]-(ec+1<NB?v[ec+1]:(Q)0); vminclose=fminq(vminclose,vc);
       if(verbose)fprintf(stderr,"t=%.19e close %d v=%g\n",(double)t,ec+1,(double)vc);}
  }
  return t;
}
// quad MAGNET MASS SPEED: MAGNET 1 or 0, MASS of the striker in kg, its SPEED in m/s; prints u and v at 1 ms and 2 ms, a line each.
int main(int argc,char**argv){
  if(argc!=4){fprintf(stderr,"usage: quad MAGNET MASS SPEED\n");return 2;}
  int mag=atoi(argv[1]); Q ms=strtoflt128(argv[2],0),vs=strtoflt128(argv[3],0); N=32; tolv=1e-22Q; tolu=tolv*1e-6Q;
  for(int k=1;k<MAXN;k++)inv[k]=1/(Q)k;
  Q Ep=1.46e9Q,np=0.46Q,Es=193e9Q,ns=0.3Q,Ea=400e9Q,na=0.22Q,R=0.00238Q,mp=0.0001226Q,mc=0.000485Q,F0=2.38Q,g=9.81Q,m1=0.00045Q;
  Q cp=(1-np*np)/Ep,cs=(1-ns*ns)/Es,ca=(1-na*na)/Ea;
  m[0]=ms;m[1]=m1;for(int i=2;i<NB;i++)m[i]=(i%2)?mc:mp;
  A[0]=(Q)4/3/(ca+cs)*sqrtq(R); A[1]=(Q)4/3/(cp+cs)*sqrtq(R/2); for(int c=2;c<NB;c++)A[c]=(Q)4/3/(cp+cs)*sqrtq(R);
  Q F=mag?F0:(Q)0; ov[0]=0; for(int c=1;c<NB;c++){F+=m[c]*g; ov[c]=powq(F/A[c],(Q)2/3);}
  for(int i=0;i<NB;i++)ext[i]=m[i]*g; if(mag)ext[1]+=F0;
  for(int i=0;i<NB;i++){u[i]=v[i]=0;closed_[i]=true;} v[0]=vs;
  int sc=0; Q t=0;
  for(int o=1;o<=2;o++){ Q te=(Q)o/1000; t=integrate(t,te,sc);
    for(int w=0;w<2;w++)for(int i=0;i<NB;i++){char b[64];quadmath_snprintf(b,64,"%.20Qe",w?v[i]:u[i]);printf("%s%c",b,i==NB-1?'\n':' ');}
  }
}
