import re,collections,sys
c=collections.defaultdict(list); n=0;tot=0
for l in open(sys.argv[1]):
    m=re.match(r'(\w+)-(\w+)-([\w.\-]+)-(\w+)\s+F \S+ err\s+(\S+)%.*?pts\s+(\d+)',l)
    if not m: continue
    b,p,r,t,e,k=m.groups(); e=float(e); r=float(r)
    if abs(e)>1 or e!=e:
        c[(b,p,'<1' if r<1 else '1-3' if r<=3 else '10+')].append((round(e,1),t,r,int(k))); n+= p!='corner'; tot+=1
for k in sorted(c): print(k,len(c[k]),[x for x in c[k]][:14])
print(n,'of 720;',tot,'of 960')
