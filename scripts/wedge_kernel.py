"""Prints the factors kappa of crates/physics/src/contact/edge.rs: how much more than a half-space an elastic wedge gives near its edge.

Waves cos(ky) along the edge on a section of nine-node elements, graded towards the edge; less the half-space on the same mesh, and
integrated over k. Needs numpy and scipy; seconds per angle.

    python3 scripts/wedge_kernel.py [ANGLE_DEG ...]
"""
import sys
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl

nu=0.3; E=1.0
ANGLES_DEG=[45,50,55,60,65,70,75,80,85,90,95,100,105,110,118,125,135]
def run(phi, nr=72, r0=2e-3, R=14.0, nth_per=None):
    lam=E*nu/((1+nu)*(1-2*nu)); mu=E/(2*(1+nu))
    nth=max(4,int(round(phi/np.radians(9))))
    # quadratic 9-node in (ln r, theta)
    NR=2*nr+1; NT=2*nth+1
    lr=np.linspace(np.log(r0),np.log(R),NR); th=np.linspace(0,phi,NT)
    X=np.exp(lr)[:,None]*np.cos(th)[None,:]; Z=np.exp(lr)[:,None]*np.sin(th)[None,:]
    nid=np.arange(NR*NT).reshape(NR,NT)
    g=np.array([-np.sqrt(.6),0,np.sqrt(.6)]); w=np.array([5,8,5])/9
    def q(x): return np.array([.5*x*(x-1),1-x*x,.5*x*(x+1)]), np.array([x-.5,-2*x,x+.5])
    els=np.array([[nid[2*i+a,2*j+b] for a in range(3) for b in range(3)] for i in range(nr) for j in range(nth)])
    xe=X.ravel()[els]; ze=Z.ravel()[els]; ne=len(els)
    Ke=np.zeros((ne,27,27)); k=1.0
    Dm=np.zeros((6,6)); Dm[:3,:3]=lam; Dm[[0,1,2],[0,1,2]]+=2*mu; Dm[[3,4,5],[3,4,5]]=mu
    for gi,wi in zip(g,w):
        for gj,wj in zip(g,w):
            N1,d1=q(gi); N2,d2=q(gj)
            N=np.outer(N1,N2).ravel(); da=np.outer(d1,N2).ravel(); db=np.outer(N1,d2).ravel()
            J11=xe@da; J12=ze@da; J21=xe@db; J22=ze@db; det=J11*J22-J12*J21
            dx=(J22[:,None]*da-J12[:,None]*db)/det[:,None]; dz=(-J21[:,None]*da+J11[:,None]*db)/det[:,None]
            # u=(ux cos, uy sin, uz cos); strains: exx,eyy,ezz, gxy(sin), gyz(sin), gxz(cos)
            B=np.zeros((ne,6,27))
            B[:,0,0::3]=dx; B[:,1,1::3]=k*N; B[:,2,2::3]=dz
            B[:,3,0::3]=-k*N; B[:,3,1::3]=dx
            B[:,4,2::3]=-k*N; B[:,4,1::3]=dz
            B[:,5,0::3]=dz; B[:,5,2::3]=dx
            Ke+=np.einsum('eai,ab,ebj,e->eij',B,Dm,B,abs(det)*wi*wj,optimize=True)
    dof=(els[:,:,None]*3+np.arange(3)).reshape(ne,27)
    I=np.repeat(dof,27,axis=1).ravel(); Jn=np.tile(dof,(1,27)).ravel()
    K=sp.csc_matrix((Ke.ravel(),(I,Jn)),shape=(3*NR*NT,)*2)
    fix=np.zeros(3*NR*NT,bool); fix[(nid[-1][:,None]*3+np.arange(3)).ravel()]=True
    free=np.where(~fix)[0]
    Kf=K[free][:,free]
    lu=sl.splu(Kf.tocsc())
    pos=-np.ones(3*NR*NT,int); pos[free]=np.arange(len(free))
    face=pos[nid[:,0]*3+2]  # normal dof z (inward = +z for body above)
    # use corner nodes only (every 2nd)
    idx=np.arange(2,NR-1,2); F=np.zeros((len(free),len(idx))); F[face[idx],np.arange(len(idx))]=1
    U=lu.solve(F)
    return np.exp(lr[idx]), U[face[idx]], lr[2]-lr[0]
if __name__=='__main__':
    r,G180,h=run(np.pi)
    n=len(r)
    c=(1-nu**2)/(np.pi*E)
    def kern(G,m):
        s=0
        for i in range(n-m): s+=0.5*(G[i,i+m]+G[i+m,i])*r[i]*h
        return s/np.pi   # K*t, t=r_i smaller, t'=t q^m
    ms=[1,2,4,8,12,16]
    print('half-space, ratio t/t\' and value (1 is exact):', [(round(np.exp(h*m),2), round(kern(G180,m)*(np.exp(h*m)-1)/c,3)) for m in ms])
    for deg in [float(a) for a in sys.argv[1:]] or ANGLES_DEG:
        r,G,h=run(np.radians(deg)); D=G-G180
        out=[]
        for m in [0,2,4,8,12,16,24]:
            ratio=np.exp(h*m); out.append(kern(D,m)*(1+ratio)/c)
        print(f'{deg} deg, kappa at t/t\'', dict(zip([round(np.exp(h*m),1) for m in [0,2,4,8,12,16,24]], np.round(out,3).tolist())), flush=True)
